"""Designs of simulated experiments: assemblies, trials and their masses.

A protocol is fixed before any parameter is drawn. The masses follow from the friction of the
paper's Table I with a margin: each trial still moves if friction is 30 % higher.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

from bayesfric.paper import table1
from bayesfric.physics.friction import Coefficients, coulomb_friction
from bayesfric.physics.gravity import Condition, nominal_tension
from bayesfric.recording.tables import STANDARD_GRAVITY

TOP_ACCELERATION = 1.2  # m/s²; 1.2 m/s after 0.6 m, within the range of Table II
LEAST_ACCELERATION = 0.2  # m/s²
FRICTION_RESERVE = 0.4  # least excess of the driving force over friction, relative to friction


class GravityTrial(NamedTuple):
    """The masses of one trial [kg]."""

    mass_drive_kg: float
    mass_load_kg: float


@dataclass(frozen=True)
class Cell:
    """The pulleys of an assembly.

    Parameters
    ----------
    pulley_size : str
        A size of Table I.
    n_pulleys : int
        Number of pulleys.
    wrap_angle_deg : float
        Average individual wrap angle [deg].
    """

    pulley_size: str
    n_pulleys: int
    wrap_angle_deg: float


@dataclass(frozen=True)
class Assembly(Cell):
    """One assembly of the gravity board and its trials, in no particular order."""

    trials: tuple[GravityTrial, ...]


@dataclass(frozen=True)
class MotorAssembly(Cell):
    """One assembly of the motor board and its weights [kg]; each is run at every speed."""

    masses_kg: tuple[float, ...]


@dataclass(frozen=True)
class Protocol:
    """A design of the gravity board, the same for every pulley size.

    Parameters
    ----------
    cells : mapping of (n, θ) to int
        Number of assemblies of each cell.
    tensions_n : tuple of float
        Nominal tensions at rest for wrap angles of 85° [N].
    angle_tensions_n : tuple of float
        Nominal tensions at rest for other wrap angles [N].
    levels : int
        Number of drive masses for each tension, from slow to fast.
    """

    cells: dict[tuple[int, float], int]
    tensions_n: tuple[float, ...]
    angle_tensions_n: tuple[float, ...]
    levels: int

    def assemblies(self) -> Iterator[Assembly]:
        """Yield the assemblies by size, and by cell in the order of :attr:`cells`."""
        for size, ((n, wrap), times) in product(table1(), self.cells.items()):
            tensions = self.tensions_n if wrap == 85.0 else self.angle_tensions_n
            trials = tuple(
                _masses(size, n, wrap, tension, level / (self.levels - 1))
                for tension, level in product(tensions, range(self.levels))
            )
            for _ in range(times):
                yield Assembly(size, n, wrap, trials)


def _masses(
    size: str, n_pulleys: int, wrap_deg: float, tension_n: float, speed_share: float
) -> GravityTrial:
    """Return the masses for a tension at rest and an acceleration.

    `speed_share` is the place of the acceleration between the least (0) and the top one (1).
    """
    total = round(2 * tension_n / STANDARD_GRAVITY, 3)
    at_rest = Condition(n_pulleys, wrap_deg, total / 2, total / 2, STANDARD_GRAVITY)
    row = table1()[size]
    law = Coefficients(row.c1.value, row.c2.value, row.c3.value)
    friction = float(coulomb_friction(law, n_pulleys, wrap_deg, nominal_tension(at_rest, 0.0)))
    least = max(LEAST_ACCELERATION, FRICTION_RESERVE * friction / total)
    target = least + speed_share * (TOP_ACCELERATION - least)
    difference = round((friction + total * target) / STANDARD_GRAVITY, 3)
    return GravityTrial(round((total + difference) / 2, 4), round((total - difference) / 2, 4))


PROTOCOLS = {
    # Figs 12 and 14 of the paper: five tensions at 85°, three at other angles.
    "paper": Protocol(
        cells={
            (5, 85.0): 1,
            (9, 85.0): 2,
            (15, 85.0): 2,
            (19, 85.0): 1,
            (5, 50.0): 1,
            (9, 50.0): 1,
            (15, 50.0): 2,
            (5, 110.0): 1,
            (9, 110.0): 2,
            (15, 110.0): 1,
            (5, 135.0): 2,
            (9, 135.0): 1,
            (15, 135.0): 1,
        },
        tensions_n=(6.0, 12.0, 18.0, 24.0, 30.0),
        angle_tensions_n=(8.0, 16.0, 28.0),
        levels=3,
    ),
    "quick": Protocol(
        cells={
            (5, 85.0): 1,
            (9, 85.0): 2,
            (15, 85.0): 1,
            (19, 85.0): 1,
            (15, 50.0): 2,
            (5, 135.0): 1,
            (15, 135.0): 2,
        },
        tensions_n=(6.0, 16.0, 30.0),
        angle_tensions_n=(6.0, 16.0, 30.0),
        levels=2,
    ),
}
"""The designs by name; ``paper`` has 594 trials in 54 setups, ``quick`` 180 in 30."""

MOTOR_ASSEMBLIES = (
    # Fig. 4: the medium pulley at five tensions. Fig. 5: the others at three.
    MotorAssembly("medium", 9, 85.0, (0.5, 1.0, 1.5, 2.2, 3.0)),
    MotorAssembly("small", 9, 85.0, (0.75, 1.5, 2.5)),
    MotorAssembly("large", 9, 85.0, (0.75, 1.5, 2.5)),
    # Fig. 6: two more wrap angles. Fig. 7: two more pulley counts.
    *(
        MotorAssembly(size, n, wrap, (1.5,))
        for n, wrap in ((9, 50.0), (9, 135.0), (5, 85.0), (15, 85.0))
        for size in ("small", "medium", "large")
    ),
)
"""Assemblies of the motor board, the same in both protocols, with 23 conditions."""

MOTOR_SPEEDS_M_S = tuple(round(0.05 + 1.25 * step / 19, 4) for step in range(20))
"""Speeds of each condition, up to the 1.3 m/s of Table II; 460 runs in total."""

IDLE_SPEEDS_M_S = tuple(round(0.05 * step, 2) for step in range(1, 27))
IDLE_REPEATS = 3
"""Number of measurements of the idle motor at each of :data:`IDLE_SPEEDS_M_S`."""

"""What an effect of the reference engine sees, and what an effect is."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from numpy.random import Generator

from bayesfric.arrays import Array as Array

Acts = Literal["pulley", "ends", "air", "drive", "load", "inertia", "reading", "clock", "current"]


@dataclass(frozen=True)
class BoardState:
    """Where a board is; arrays that broadcast, trials (or runs) on the first axis.

    Parameters
    ----------
    travel_m, speed_m_s, acceleration_m_s2 : ndarray
        Of the cable since the release; travel and acceleration are 0 in a steady run.
    order : ndarray
        Place in the order of the board's rows, from 0 to 1.
    drive_end : ndarray
        Which end carries the drive mass: −0.5 the left, 0.5 the right, 0 on the motor board.
    trial_in_setup : ndarray
        Trials of the same assembly that went before; 0 on the motor board.
    size : ndarray of int
        Pulley size, as its place in :data:`~.law.SIZES`.
    n_pulleys, wrap_angle_deg, radius_m : ndarray
        Of the pulleys.
    slope, constant_n : ndarray
        One pulley's friction by the law: slope × tension + constant.
    scale_n : ndarray
        One pulley's friction at 15 N and 85° [N].
    tension_n : ndarray
        Half of the weight on both ends, or the weight that hangs on the motor board [N].
    gravity_m_s2 : float
        Local acceleration of free fall.
    steady : bool
        True on the motor board.
    """

    travel_m: Array
    speed_m_s: Array
    acceleration_m_s2: Array
    order: Array
    drive_end: Array
    trial_in_setup: Array
    size: Array
    n_pulleys: Array
    wrap_angle_deg: Array
    radius_m: Array
    slope: Array
    constant_n: Array
    scale_n: Array
    tension_n: Array
    gravity_m_s2: float
    steady: bool

    def friction(self, tension: Array) -> Array:
        """Return one pulley's friction by the law at the tension that enters it [N]."""
        return self.slope * tension + self.constant_n


@dataclass(frozen=True)
class Passage:
    """Where the cable is as the magnets pass a sensor; arrays (trials, events).

    Parameters
    ----------
    event : ndarray
        Number of the event, 0 being the first.
    at_load : bool
        Whether the sensor is at the load end.
    displacement_m : ndarray
        Travel since the sensor's first event, as it is written down.
    time_s, speed_m_s : ndarray
        Since the release; of the cable.
    drive_kg, load_kg : ndarray
        Masses, (trials, 1).
    order : ndarray
        Place in the order of the trials, from 0 to 1, (trials, 1).
    friction_n : ndarray
        Friction of the law, (trials, 1) [N].
    magnets : int
        On the sensor pulley.
    """

    event: Array
    at_load: bool
    displacement_m: Array
    time_s: Array
    speed_m_s: Array
    drive_kg: Array
    load_kg: Array
    order: Array
    friction_n: Array
    magnets: int


Law = Callable[[Mapping[str, Any], Any, Any], Any]


def no_parameters(rng: Generator, trials: int) -> dict[str, Any]:
    """Draw nothing: the form has an amplitude and no shape."""
    return {}


@dataclass(frozen=True)
class Form:
    """One functional form of an effect.

    Parameters
    ----------
    name : str
        Within the effect.
    own : bool
        Whether the package's own effect has this form.
    law : callable
        (parameters, where, tension) to a number. `where` is a :class:`BoardState`, or a
        :class:`Passage` for a sensor. What is returned depends on `acts`.
    acts : str
        ``pulley``: friction of one pulley [N] at the tension that enters it; ``ends``:
        friction, half of it at either end of the cable [N]; ``air``: the same, but trial
        and setup scatter leave it alone; ``drive``, ``load``: a force at that end that
        scatter leaves alone [N]; ``inertia``: mass that a pulley moves along [kg];
        ``reading``: by how much a magnet passes beyond its place [m]; ``clock``: share
        by which a time reads too long; ``current``: addition to the current of a run [A],
        where the tension is the load current [A].
    draw : callable
        (generator, number of trials) to the shape's parameters; an array has a number
        for each trial.
    affine : bool
        Whether the law is a straight line in tension.
    """

    name: str
    own: bool
    law: Law
    acts: Acts = "pulley"
    draw: Callable[[Generator, int], dict[str, Any]] = no_parameters
    affine: bool = True


@dataclass(frozen=True)
class Kind:
    """An effect: what may be withheld.

    Parameters
    ----------
    name : str
        Of an effect, or of an outsider.
    amplitude : str
        Name of the parameter that is 0 where the effect is absent.
    forms : tuple of Form
        An own one first, where there is one.
    axes : tuple of str
        Along which it shows.
    signed : bool
        Whether either sign is physical.
    needs : str
        ``""``, ``"motor"`` or ``"both sensors"``.
    boards : tuple of str
        Where it acts.
    """

    name: str
    amplitude: str
    forms: tuple[Form, ...]
    axes: tuple[str, ...]
    signed: bool = False
    needs: str = ""
    boards: tuple[str, ...] = ("gravity", "motor")


@dataclass(frozen=True)
class ImposedEffect:
    """One effect in one case: a form with numbers.

    Parameters
    ----------
    kind : Kind
        The effect.
    form : Form
        Its form.
    shape : mapping
        Parameters but the amplitude.
    amplitude : float
        With its sign.
    strength : float
        Asked for; 1 is 10 % rms of friction.
    """

    kind: Kind
    form: Form
    shape: Mapping[str, Any] = field(default_factory=dict)
    amplitude: float = 0.0
    strength: float = 0.0

    def __call__(self, where: BoardState | Passage, tension: Any = 0.0) -> Any:
        """Return what the form's law does here."""
        return self.form.law({"amplitude": self.amplitude, **self.shape}, where, tension)

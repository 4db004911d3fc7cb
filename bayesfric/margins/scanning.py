"""The reference speeds and kicks for which hunting is simulated.

If the reference moves less than one count per sample, a compensator of the measured speed is off
for most of the time. The shaft then slips and sticks at gains far below those at which it hunts at
rest. A gain is therefore safe only if it is safe at rest and at every speed.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.margins.hunting import after_a_kick
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.swing import LoopMotion

COUNTS_A_SAMPLE = (0.1, 0.2, 0.5, 1.0, 1.5, 2.5, 5.0, 10.0)
"""Default reference speeds besides rest, in encoder counts per sample."""
GAMMAS = (0.0, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0)
OF_A_RANGE = 6


@dataclass(frozen=True)
class Condition:
    """A reference speed and a kick with which the loop is simulated.

    Parameters
    ----------
    counts : float or None
        Reference speed in encoder counts per sample.
    speed : float or None
        The same in rad/s at the motor. At most one of the two is given; if both are None, it is
        the speed of the file.
    kick : float
        Kick, over the file's kick.
    """

    counts: float | None = None
    speed: float | None = None
    kick: float = 1.0

    def speed_of(self, shaft: LoopAtShaft) -> Array:
        """Return the reference speed of each draw, at the motor [rad/s]."""
        if self.counts is not None:
            return self.counts * 2 * np.pi / shaft.counts / shaft.sample_time
        if self.speed is not None:
            return np.full(shaft.friction.shape, self.speed)
        return shaft.reference_speed

    def kick_of(self, shaft: LoopAtShaft) -> Array:
        """Return the kick of each draw, at the motor [rad]."""
        return self.kick * shaft.kick


REST = Condition(speed=0.0)


def speeds_of(shaft: LoopAtShaft) -> tuple[Condition, ...]:
    """Return rest and the reference speeds at which hunting is searched for.

    They span the range of the file, or else 0.1 to 10 encoder counts per sample, up to the joint's
    peak speed. The reference speed of the file's kick is added.
    """
    given = shaft.loop.kick.reference_range_rad_s
    speeds = [REST]
    if given is None:
        peak = float(np.median(shaft.peak_velocity)) or np.inf
        count = float(np.median(2 * np.pi / shaft.counts / shaft.sample_time))
        speeds += [Condition(counts=counts) for counts in COUNTS_A_SAMPLE if counts * count <= peak]
    elif given[1] > 0.0:
        low, high = given
        steps = np.geomspace(low or high / 100, high, OF_A_RANGE if high > low else 1)
        speeds += [Condition(speed=float(speed)) for speed in steps]
    if (shaft.reference_speed != 0.0).any():
        speeds.append(Condition())
    return tuple(speeds)


def speeds_and_kicks(shaft: LoopAtShaft, conditions: Sequence[Condition]) -> tuple[Array, Array]:
    """Return the reference speeds and kicks of conditions, (conditions, draws) [rad/s, rad]."""
    speeds = np.array([condition.speed_of(shaft) for condition in conditions])
    return speeds, np.array([condition.kick_of(shaft) for condition in conditions])


@dataclass(frozen=True)
class HuntingMap:
    """A map over reference speed and γ of the draws that hunt.

    Parameters
    ----------
    speeds : tuple of Condition
        S reference speeds.
    gammas : tuple of float
        G gains.
    hunts : ndarray of bool, shape (G, S, draws)
        Whether each draw hunts.
    rms_error : ndarray, shape (G, S, draws)
        Rms error of the last half of each run, at the motor [rad].
    """

    speeds: tuple[Condition, ...]
    gammas: tuple[float, ...]
    hunts: Flags
    rms_error: Array


def run(shaft: LoopAtShaft, conditions: tuple[Condition, ...], gamma: Array) -> LoopMotion:
    """Simulate every draw in every condition.

    Parameters
    ----------
    shaft : LoopAtShaft
        The draws.
    conditions : tuple of Condition
        C of them.
    gamma : ndarray, shape (draws,)
        The gain.

    Returns
    -------
    LoopMotion
        With arrays of shape (C · draws,), the draws of a condition adjacent.
    """
    loop = shaft.sampled(gamma)
    loop = loop.taken(np.tile(np.arange(loop.draws), len(conditions)))
    speed, kick = speeds_and_kicks(shaft, conditions)
    return after_a_kick(loop, kick.ravel(), speed.ravel())


def look(
    shaft: LoopAtShaft,
    speeds: tuple[Condition, ...],
    few: Whole,
    gammas: tuple[float, ...] = GAMMAS,
) -> tuple[HuntingMap, LoopMotion]:
    """Simulate draws at every speed, after the file's kick, in one vectorised run.

    A step of one run costs nearly as much as a step of many.

    Parameters
    ----------
    shaft : LoopAtShaft
        The draws.
    speeds : tuple of Condition
        S reference speeds.
    few : ndarray of int, shape (m,)
        Draws of the map.
    gammas : tuple of float
        G gains of the map.

    Returns
    -------
    HuntingMap
        Map of these draws.
    LoopMotion
        Motion of all draws at their own gain, with arrays of shape (S, draws).
    """
    draws, mapped = shaft.friction.size, len(gammas) * few.size
    rows = np.concatenate([np.tile(few, len(gammas)), np.arange(draws)])
    gamma = np.concatenate([np.repeat(gammas, few.size), shaft.gamma])
    motion = run(shaft.taken(rows), speeds, gamma)
    arrays = {name: values.reshape(len(speeds), -1) for name, values in vars(motion).items()}

    def chart(name: str) -> NDArray[Any]:
        table = arrays[name][:, :mapped].reshape(len(speeds), len(gammas), few.size)
        return np.asarray(table.swapaxes(0, 1))

    own = LoopMotion(**{name: values[:, mapped:] for name, values in arrays.items()})
    return HuntingMap(speeds, gammas, chart("hunts"), chart("rms_error")), own

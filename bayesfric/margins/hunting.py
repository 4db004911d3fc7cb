"""The compensation gain at which a loop begins to hunt, found by simulation.

Let the compensator follow the sign of the measured speed, be off at rest, and the reference be
fixed. Then an oscillation repeats at the amplitude (γF̂ − F)/kp · coth(πζ/(2√(1 − ζ²))), and lasts
if this exceeds F/kp, within which friction holds the shaft. So hunting begins at

    γ* = (F/F̂)(1 + tanh(πζ/(2√(1 − ζ²)))) ≈ (F/F̂)(1 + πζ/2)

if F/kp is many encoder counts, the shaft at its fastest travels several counts in a sample
(F ω_n T/kp above 3 counts), and the kick exceeds F/kp. The simulation is then within 10 % of the
first form up to ζ = 0.84, and of the second up to ζ = 0.7. With fewer counts the compensator is off
for much of a cycle, and γ* is higher. If the reference moves so slowly that most samples read no
motion, shafts slip and stick even at γ below F/F̂. Only the simulation covers these cases.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.margins.margin_rules import MARGIN_RULES
from bayesfric.margins.sampled_loop import SampledLoop
from bayesfric.margins.simulating import simulate
from bayesfric.margins.swing import LoopMotion

SHORTEST_S, LONGEST_S = 0.5, 60.0
TRIED_AT_ONCE = 4
EVERY_TENTH = tuple(round(0.1 * step, 1) for step in range(31))
"""Gains from 0 to 3."""
MOST_SETTLING_S = 5.0
"""If a linear loop takes longer to settle than this, its decay is judged instead."""
SLIPS = 12.0
"""Number of stuck bands that a reference passes in a run: six slips of the longest kind."""
CYCLES = 6.0
"""Number of slow cycles of integral action in a run."""
SLOWER_ON_A_CABLE = 3.0
"""Largest observed period of a slow cycle on an elastic cable over that on a stiff cable: the motor
slips less far while the joint stands still."""
LEAST_EXCESS = 0.02
"""Relative excess of breakaway over moving friction, below which no slow cycle is waited for."""
LASTS = (0.6, MARGIN_RULES.swing_lasts)
"""Least and largest share of its amplitude that a lasting oscillation keeps."""
LEAST_WIDTH = 1e-3
"""Least width of the bisection."""


class RunLength(NamedTuple):
    """Durations of the runs of draws, each of shape (draws,) [s].

    Parameters
    ----------
    duration : ndarray
        Duration of the run, at most 60 s.
    settling : ndarray
        Time after which a shaft that moves all the time has settled or oscillates.
    wanted : ndarray
        Duration that the run should have. If it exceeds `duration`, a slow cycle may be missed.
    lasts : ndarray
        Share of its amplitude that a lasting oscillation keeps from one stretch to the next
        [-]: midway between 1 and the share that damping alone leaves. Slips are irregular, so a
        larger share is required only if damping is slow.
    """

    duration: Array
    settling: Array
    wanted: Array
    lasts: Array


def run_length(loop: SampledLoop, reference_speed: ArrayLike = 0.0) -> RunLength:
    """Return how long each draw must run until it has settled or hunts.

    The duration is the longest of: eight time constants 2J/|b_eff| of the linear loop, with
    b_eff = kd + b − kp (delay + T/2); ten of its periods; twelve times the time in which the
    reference travels F/kp, after which a stuck shaft moves; and, with integral action, eight times
    kp/ki and six slow cycles. In a slow cycle the shaft rests at an error δ/kp, with the excess δ
    of breakaway Fs over moving friction, until the integral has gone from one side to the other. So
    the cycle lasts 4 (kp/ki) Fs/δ.

    Parameters
    ----------
    loop : SampledLoop
        The loop.
    reference_speed : array_like
        Speed of the reference [rad/s], a scalar or (draws,).

    Returns
    -------
    RunLength
        Durations of at least 0.5 s.
    """
    tiny = np.finfo(np.float64).tiny
    inertia, kp = loop.inertia, np.maximum(np.abs(loop.kp), tiny)
    speed = np.abs(np.broadcast_to(reference_speed, loop.draws))
    friction, ki = loop.friction, np.abs(loop.ki)
    lag = loop.delay + loop.sample_time / 2.0
    damping = np.abs(loop.kd + loop.viscous - kp * lag)
    breakaway = loop.breakaway
    excess = breakaway - friction
    if loop.compensation_signal == "measured" and loop.at_rest == "off":
        # a compensator that is off at rest does not reduce friction there
        excess = excess + loop.compensation_gain * loop.compensation_estimate
    sticks = excess > LEAST_EXCESS * friction
    with np.errstate(over="ignore"):  # infinite times are cut to the longest
        settled = 16.0 * inertia / np.maximum(damping, tiny)
        periods = 20.0 * np.pi * np.sqrt(inertia / kp)
        dragged = np.where(speed > 0.0, SLIPS * friction / kp / np.maximum(speed, tiny), 0.0)
        reset = kp / np.maximum(ki, tiny)
        slow = (
            CYCLES
            * 4.0
            * reset
            * np.divide(breakaway, excess, out=np.zeros_like(excess), where=sticks)
        )
        slow = slow if loop.cable is None else SLOWER_ON_A_CABLE * slow
        slow = np.where(ki > 0.0, np.maximum(8.0 * reset, slow), 0.0)
        linear = np.minimum(np.maximum(settled, periods), MOST_SETTLING_S)
    wanted = np.maximum(np.max([linear, dragged, slow], axis=0), SHORTEST_S)
    settling = np.maximum(linear, SHORTEST_S) / 2.0
    left = np.exp(-settling / 2.0 * damping / (2.0 * inertia))  # over half of the settling time
    lasts = np.clip((1.0 + left) / 2.0, *LASTS)
    return RunLength(np.minimum(wanted, LONGEST_S), settling, wanted, lasts)


def after_a_kick(loop: SampledLoop, kick: Array, reference_speed: Array) -> LoopMotion:
    """Simulate each draw until it has settled or hunts; arguments are of shape (draws,)."""
    length = run_length(loop, reference_speed)
    return simulate(
        loop,
        kick=kick,
        duration=length.duration,
        settling=length.settling,
        lasts=length.lasts,
        reference_speed=reference_speed,
    )


@dataclass(frozen=True)
class Thresholds:
    """The threshold of each draw, above which it hunts.

    Parameters
    ----------
    gamma : ndarray, shape (draws,)
        The smallest γ found to hunt; 0 if the loop hunts without compensation, infinite if it
        does not hunt up to the maximum.
    condition : ndarray of int, shape (draws,)
        Index of the condition that hunts there; −1 if none does.
    """

    gamma: Array
    condition: Whole


def hunting_threshold(
    loop: SampledLoop,
    *,
    kick: ArrayLike,
    reference_speed: ArrayLike = 0.0,
    gammas: Sequence[float] = EVERY_TENTH,
    tolerance: float = MARGIN_RULES.threshold_tolerance,
    hunts_at: ArrayLike = np.inf,
    expected: int = TRIED_AT_ONCE,
) -> Thresholds:
    """Return the smallest compensation gain γ at which each draw hunts in any condition.

    All draws are run at one γ after another. The threshold is then found by bisection between the
    first γ that hunts and the one before. A band of hunting γ that is narrower than the steps may
    be missed. Encoder steps cause such bands just below the threshold.

    Parameters
    ----------
    loop : SampledLoop
        The loop; its own compensation gain is not used.
    kick : array_like
        Initial position ahead of the reference [rad]: a scalar, (draws,), or (conditions, draws).
    reference_speed : array_like
        Speed of the reference [rad/s], of one of these shapes.
    gammas : sequence of float
        The γ that are simulated first, increasing from 0.
    tolerance : float
        Final width of the bisection; for smaller thresholds, a share `threshold_share`.
    hunts_at : array_like
        γ at which each draw hunts in another condition, a scalar or (draws,). No larger γ is tried.
    expected : int
        Index in `gammas` by which most draws hunt. It affects the time only, not the result.

    Returns
    -------
    Thresholds
        Threshold of each draw.
    """
    grid = np.asarray(gammas, dtype=np.float64)
    hunts = _hunts(loop, kick, reference_speed)
    threshold, below = np.full(loop.draws, np.inf), np.zeros(loop.draws)
    condition = np.full(loop.draws, -1, dtype=np.intp)
    most = np.broadcast_to(hunts_at, loop.draws)
    before = np.concatenate([[-1.0], grid[:-1]])
    for begin, end in _tried_together(grid.size, expected):
        left = np.flatnonzero(np.isinf(threshold) & (before[begin] < most))
        if not left.size:
            break
        some = np.minimum(grid[begin:end, None], most[left])
        needed = before[begin:end, None] < most[left]
        does = hunts(left[np.nonzero(needed)[1]], some[needed])
        table = np.zeros((len(does), *some.shape), dtype=bool)
        table[:, needed] = does
        any_hunts = table.any(axis=0)
        newly, at = any_hunts.any(axis=0), any_hunts.argmax(axis=0)
        rows, first = left[newly], begin + at[newly]
        threshold[rows] = np.minimum(grid[first], most[rows])
        below[rows] = grid[np.maximum(first - 1, 0)]
        condition[rows] = table[:, at[newly], np.flatnonzero(newly)].argmax(axis=0)
    return _bisect(Thresholds(threshold, condition), below, hunts, tolerance)


def _hunts(
    loop: SampledLoop, kick: ArrayLike, reference_speed: ArrayLike
) -> Callable[[Whole, Array], Flags]:
    """Return a function: (indices of m draws, a gain for each) to whether each condition hunts."""
    kicks, speeds = (
        np.atleast_2d(np.asarray(values, dtype=np.float64)) for values in (kick, reference_speed)
    )
    shape = np.broadcast_shapes(kicks.shape, speeds.shape, (1, loop.draws))
    kicks, speeds = np.broadcast_to(kicks, shape), np.broadcast_to(speeds, shape)

    def hunts(index: Whole, gamma: Array) -> Flags:
        """Return which conditions hunt, of shape (conditions, m)."""
        rows = np.tile(index, shape[0])
        tried = replace(loop.taken(rows), compensation_gain=np.tile(gamma, shape[0]))
        motion = after_a_kick(tried, kicks[:, index].ravel(), speeds[:, index].ravel())
        return motion.hunts.reshape(shape[0], index.size)

    return hunts


def _tried_together(count: int, expected: int) -> Iterable[tuple[int, int]]:
    """Return begin and end of the groups of `count` gains that are simulated at once."""
    # a loop that hunts without compensation needs no more than the first
    first_group = 1 + min(max(expected, 1), TRIED_AT_ONCE)
    begins = {0, min(1, count - 1), *range(first_group, count, TRIED_AT_ONCE)}
    return pairwise(sorted(begins | {count}))


def _bisect(
    thresholds: Thresholds,
    below: Array,
    hunts: Callable[[Whole, Array], Flags],
    tolerance: float,
) -> Thresholds:
    """Bisect thresholds down to a tolerance, or to a share `threshold_share` of smaller ones.

    Parameters
    ----------
    thresholds : Thresholds
        Gains at which draws hunt; changed in place.
    below : ndarray, shape (draws,)
        Smaller gains at which they do not hunt; changed in place.
    hunts : callable
        (indices of draws, a gain for each) to whether each condition hunts.
    tolerance : float
        Final width of the bisection.
    """
    threshold, condition = thresholds.gamma, thresholds.condition
    while True:
        near = np.minimum(
            tolerance, np.maximum(MARGIN_RULES.threshold_share * threshold, LEAST_WIDTH)
        )
        wide = np.isfinite(threshold) & (threshold - below > near)
        if not wide.any():
            return thresholds
        index = np.flatnonzero(wide)
        middle = (threshold[index] + below[index]) / 2.0
        table = hunts(index, middle)
        does = table.any(axis=0)
        threshold[index] = np.where(does, middle, threshold[index])
        below[index] = np.where(does, below[index], middle)
        condition[index] = np.where(does, table.argmax(axis=0), condition[index])

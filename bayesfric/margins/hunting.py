"""The compensation gain at which a loop begins to hunt, found by simulation.

With the compensator on the sign of the measured speed, off at rest, and a fixed
reference, a swing repeats at an amplitude of (γF̂ − F)/kp · coth(πζ/(2√(1 − ζ²))),
and goes on if that exceeds F/kp, where friction holds the shaft. So hunting begins at

    γ* = (F/F̂)(1 + tanh(πζ/(2√(1 − ζ²)))) ≈ (F/F̂)(1 + πζ/2)

as long as F/kp is many encoder counts, the shaft at full swing travels several counts in
a sample (F ω_n T/kp above 3 counts), and the kick exceeds F/kp. Then the simulator is
within 10 % of the first form up to ζ = 0.84, and of the second up to ζ = 0.7. With fewer
counts the compensator is off for much of a swing and γ* is higher; where the reference
moves so slowly that most samples read no motion, shafts slip and stick at γ below F/F̂ too.
Only the simulation knows these.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bayesfric.margins.sampled_loop import SampledLoop, simulate

__all__ = ["hunting_threshold", "settling_duration"]

Floats = NDArray[np.float64]

SHORTEST_S, LONGEST_S = 0.5, 5.0
TRIED_AT_ONCE = 8


def settling_duration(loop: SampledLoop, reference_speed: ArrayLike = 0.0) -> float:
    """Return a length of run after which a loop has settled or hunts.

    Whichever is longest for the slowest draw: eight time constants 2J/|b_eff| of the linear
    loop, with b_eff = kd + b − kp (delay + T/2); ten of its periods; five times that the
    reference takes for 2F/kp, in which it drags a shaft off that sticks. Between 0.5 and 5 s.
    The slow hunting of integral action may take longer.

    Parameters
    ----------
    loop : SampledLoop
        The loop.
    reference_speed : array_like
        Speed of the reference [rad/s], a scalar or (draws,).

    Returns
    -------
    float
        Duration [s].
    """
    tiny = np.finfo(np.float64).tiny
    inertia, kp = loop.array("inertia"), np.maximum(np.abs(loop.array("kp")), tiny)
    speed = np.abs(loop.per_draw("reference_speed", reference_speed))
    lag = loop.array("delay") + loop.array("sample_time") / 2.0
    damping = np.abs(loop.array("kd") + loop.array("viscous") - kp * lag)
    with np.errstate(over="ignore"):  # what takes for ever is cut to the longest
        settled = 16.0 * inertia / np.maximum(damping, tiny)
        periods = 20.0 * np.pi * np.sqrt(inertia / kp)
        dragged = 10.0 * loop.array("friction") / kp / np.maximum(speed, tiny)
    dragged = np.where(speed > 0.0, dragged, 0.0)
    longest = np.max([settled, periods, dragged])
    return float(np.clip(longest, SHORTEST_S, LONGEST_S))


def hunting_threshold(
    loop: SampledLoop,
    *,
    kick: ArrayLike,
    reference_speed: ArrayLike = 0.0,
    duration: float | None = None,
    maximum_gamma: float = 3.0,
    step: float = 0.1,
    tolerance: float = 0.01,
) -> Floats:
    """Return the smallest compensation gain γ at which each draw hunts.

    All draws are run at γ = 0, step, 2 step, … up to the maximum; the first that hunts
    is then approached by bisection. A band of γ that hunts and is narrower than the step
    may be missed; encoder steps make such bands just below the threshold.

    Parameters
    ----------
    loop : SampledLoop
        The loop; its own compensation gain is not used.
    kick : array_like
        Position ahead of the reference at the beginning [rad], a scalar or (draws,).
    reference_speed : array_like
        Speed of the reference [rad/s], a scalar or (draws,).
    duration : float or None
        Length of each run [s]; None takes :func:`settling_duration`.
    maximum_gamma : float
        The largest γ that is tried.
    step : float
        Distance of the first search.
    tolerance : float
        Width to which the bisection goes.

    Returns
    -------
    ndarray, shape (draws,)
        The smallest γ found to hunt; 0 where the loop hunts without compensation, infinite
        where it does not hunt up to the maximum.

    Raises
    ------
    ValueError
        Where an argument cannot be used.
    """
    for name, value in (("maximum_gamma", maximum_gamma), ("step", step), ("tolerance", tolerance)):
        if not (np.isfinite(value) and value > 0.0):
            raise ValueError(f"{name}: expected a positive number, got {value}")
    kicks = loop.per_draw("kick", kick)
    speeds = loop.per_draw("reference_speed", reference_speed)
    length = settling_duration(loop, speeds) if duration is None else duration

    def hunts(index: NDArray[np.intp], gamma: Floats) -> NDArray[np.bool_]:
        tried = replace(loop.taken(index), compensation_gain=gamma)
        return simulate(
            tried, kick=kicks[index], duration=length, reference_speed=speeds[index]
        ).hunts

    gammas = np.append(np.arange(0.0, maximum_gamma - 1e-9, step), maximum_gamma)
    threshold, below = np.full(loop.draws, np.inf), np.zeros(loop.draws)
    for begin in range(0, gammas.size, TRIED_AT_ONCE):
        some = gammas[begin : begin + TRIED_AT_ONCE]
        left = np.flatnonzero(np.isinf(threshold))
        if not left.size:
            break
        table = hunts(np.tile(left, some.size), np.repeat(some, left.size))
        table = table.reshape(some.size, left.size)
        found, first = table.any(axis=0), begin + table.argmax(axis=0)
        threshold[left[found]] = gammas[first[found]]
        below[left[found]] = gammas[np.maximum(first[found] - 1, 0)]
    while True:
        wide = np.isfinite(threshold) & (threshold - below > tolerance)
        if not wide.any():
            return threshold
        index = np.flatnonzero(wide)
        middle = (threshold[index] + below[index]) / 2.0
        does = hunts(index, middle)
        threshold[index] = np.where(does, middle, threshold[index])
        below[index] = np.where(does, below[index], middle)

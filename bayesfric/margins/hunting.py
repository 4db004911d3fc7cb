"""The compensation gain at which a loop begins to hunt, found by simulation."""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bayesfric.margins.sampled_loop import SampledLoop, simulate

__all__ = ["hunting_threshold", "settling_duration"]

Floats = NDArray[np.float64]

SHORTEST_S, LONGEST_S = 0.5, 5.0


def settling_duration(loop: SampledLoop) -> float:
    """Return a length of run after which a loop has settled or hunts.

    Eight time constants 2J/|b_eff| of the linear loop and ten of its periods, whichever
    is longer for the slowest draw, with b_eff = kd + b − kp (delay + T/2); between 0.5 and
    5 s. The slow hunting of integral action is not thought of.

    Parameters
    ----------
    loop : SampledLoop
        The loop.

    Returns
    -------
    float
        Duration [s].
    """
    inertia, kp = loop.array("inertia"), np.abs(loop.array("kp"))
    lag = loop.array("delay") + loop.array("sample_time") / 2.0
    damping = np.abs(loop.array("kd") + loop.array("viscous") - kp * lag)
    tiny = np.finfo(np.float64).tiny
    settled = 16.0 * inertia / np.maximum(damping, tiny)
    periods = 20.0 * np.pi * np.sqrt(inertia / np.maximum(kp, tiny))
    return float(np.clip(np.maximum(settled, periods).max(), SHORTEST_S, LONGEST_S))


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
    may be missed.

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
        The threshold is at most this much too high.

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
    draws = loop.draws
    kicks, speeds = (
        np.broadcast_to(np.asarray(value, dtype=np.float64), draws)
        for value in (kick, reference_speed)
    )
    length = settling_duration(loop) if duration is None else duration

    def hunts(index: NDArray[np.intp], gamma: Floats) -> NDArray[np.bool_]:
        tried = replace(loop.taken(index), compensation_gain=gamma)
        return simulate(
            tried, kick=kicks[index], duration=length, reference_speed=speeds[index]
        ).hunts

    gammas = np.append(np.arange(0.0, maximum_gamma - 1e-9, step), maximum_gamma)
    everyone = np.tile(np.arange(draws), gammas.size)
    table = hunts(everyone, np.repeat(gammas, draws)).reshape(gammas.size, draws)
    first = table.argmax(axis=0)
    threshold = np.where(table.any(axis=0), gammas[first], np.inf)
    below = gammas[np.maximum(first - 1, 0)]
    while (open_ := np.flatnonzero(np.isfinite(threshold) & (threshold - below > tolerance))).size:
        middle = (threshold[open_] + below[open_]) / 2.0
        does = hunts(open_, middle)
        threshold[open_] = np.where(does, middle, threshold[open_])
        below[open_] = np.where(does, below[open_], middle)
    return threshold

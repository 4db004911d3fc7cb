"""The smoothed path of a joint, for the forces that its motion causes on joints and payloads."""

from dataclasses import dataclass

import numpy as np

from bayesfric.arrays import Array
from bayesfric.rigs.single_axis.even_log import (
    EvenLog,
    local_polynomial,
    position_noise,
    slope_weights,
)

DEGREE = 3  # degree of the smoothing polynomial
FINE = 0.003  # error of a smoothed speed that is small enough, relative to the top speed
LEAST_HALF, MOST_S = 4, 0.1  # least samples, and longest time [s], on either side
SHOWN = 20.0  # range of positions from which a joint moves, in standard errors of a position


@dataclass(frozen=True)
class Path:
    """The smoothed path of a joint.

    Parameters
    ----------
    position, velocity : ndarray, shape (N,)
        Smoothed, at the samples of its own log or of another joint's [m or rad], [m/s or rad/s].
    error : float
        Standard deviation of a measured position [m or rad].
    interval_s : float
        Time between samples of the joint's own log [s].
    """

    position: Array
    velocity: Array
    error: float
    interval_s: float


def path_of(log: EvenLog, time_s: Array | None = None) -> Path:
    """Return a joint's smoothed path.

    Parameters
    ----------
    log : EvenLog
        The log of the joint.
    time_s : ndarray, shape (N,), or None
        Times of the result [s]; None means the times of the log.
    """
    noise, step = position_noise(log, None), log.interval_s
    largest_half = max(LEAST_HALF, min(round(MOST_S / step), (log.time_s.size - 1) // 2))
    half = LEAST_HALF
    while half < largest_half:
        error = noise * np.linalg.norm(slope_weights(half, DEGREE)) / step
        velocity = local_polynomial(log.position, half, DEGREE, slope=True) / step
        if error < FINE * np.abs(velocity).max():
            break
        half = min(largest_half, half + max(1, half // 4))
    position = local_polynomial(log.position, half, DEGREE)
    velocity = local_polynomial(log.position, half, DEGREE, slope=True) / step
    if time_s is None:
        return Path(position, velocity, noise, step)
    return Path(
        np.interp(time_s, log.time_s, position),
        np.interp(time_s, log.time_s, velocity),
        noise,
        step,
    )


def moves(path: Path) -> bool:
    """Return whether the log shows that a joint moves."""
    return bool(np.ptp(path.position) > SHOWN * path.error)

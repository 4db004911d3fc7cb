"""The path of a joint, smoothed: what its place and speed do to other joints, and to a payload."""

from dataclasses import dataclass

import numpy as np
import scipy

from bayesfric.arrays import Array
from bayesfric.rigs.single_axis.even_log import EvenLog, local_polynomial, position_noise

DEGREE = 3  # of the polynomial by which a path is smoothed
FINE = 0.003  # of the top speed, to which a smoothed speed is told
LEAST_HALF, MOST_S = 4, 0.1  # samples on either side; and no more than so long [s]
SHOWN = 20.0  # errors of a position, by which a joint moves that moves


@dataclass(frozen=True)
class Path:
    """Where a joint is, (N,) each, on the grid of another.

    Parameters
    ----------
    position, velocity : ndarray, shape (N,)
        Smoothed.
    error : float
        Standard deviation of a position as it was measured.
    interval_s : float
        Between samples of the joint's own log.
    """

    position: Array
    velocity: Array
    error: float
    interval_s: float


def path_of(log: EvenLog, time_s: Array | None = None) -> Path:
    """Return a joint's smoothed path, at other times where such are given.

    Parameters
    ----------
    log : EvenLog
        Of the joint.
    time_s : ndarray, shape (N,), or None
        Times [s]; None is those of the log.
    """
    noise, step = position_noise(log, None), log.interval_s
    most = max(LEAST_HALF, min(round(MOST_S / step), (log.time_s.size - 1) // 2))
    half = LEAST_HALF
    while half < most:
        kernel = scipy.signal.savgol_coeffs(2 * half + 1, DEGREE, deriv=1, delta=step)
        velocity = local_polynomial(log.position, half, DEGREE, slope=True) / step
        if noise * np.linalg.norm(kernel) < FINE * np.abs(velocity).max():
            break
        half = min(most, half + max(1, half // 4))
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
    """Return whether a joint is seen to move."""
    return bool(np.ptp(path.position) > SHOWN * path.error)

"""The second derivative of the force around a window, without the errors of its mean force."""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from bayesfric.arrays import Array
from bayesfric.rigs.single_axis.even_log import EvenLog
from bayesfric.rigs.single_axis.weak_form import TestFunction

BESIDE = 3  # half windows from which the second derivative is estimated


def force_curvature(
    log: EvenLog, test: TestFunction, centres: NDArray[np.intp], runs: Array
) -> Array:
    """Return the second derivative of the force around each window, shape (W,) [N/s²].

    An estimate from the window's own samples would contain the errors of its mean force with
    opposite sign: a row would be explained by its own error. They are used only if the axis
    reverses too close to the window: friction jumps there, and a compliance responds to the jump.

    Parameters
    ----------
    log : EvenLog
        A run.
    test : TestFunction
        Test function of the windows.
    centres : ndarray of int, shape (W,)
        Middle sample of each window.
    runs : ndarray, shape (N + 1,)
        Sum of the directions (1, −1, or 0 if unknown) of all samples before each sample.
    """
    half, count = test.half, log.time_s.size
    wide = BESIDE * half
    curvature = test.over(log.force, test.curvature, centres)
    free = (centres >= wide) & (centres < count - wide)
    inside = centres[free]
    free[free] = np.abs(runs[inside + wide + 1] - runs[inside - wide]) == 2 * wide + 1
    if free.any():
        kernel = _beside(half, wide, log.interval_s)
        windows = sliding_window_view(log.force, kernel.size)
        curvature[free] = windows[centres[free] - wide] @ kernel
    return curvature


def _beside(half: int, wide: int, interval_s: float) -> Array:
    """Return weights of samples outside a window for a second derivative, (2 wide + 1,)."""
    place = np.arange(-wide, wide + 1.0)
    weight = np.where(np.abs(place) > half, (1 - (place / (wide + 1)) ** 2), 0.0)
    time2 = (place / wide) ** 2
    powers = np.stack([time2**power for power in range(3)])
    # The weights give 0 for a constant and for t⁴, and the second derivative of t².
    numbers = np.linalg.solve(
        (powers * weight) @ powers.T, [0.0, 2 / (wide * interval_s) ** 2, 0.0]
    )
    return np.asarray(weight * (numbers @ powers))

"""The force's second derivative about a window, apart from the errors of the mean force in it."""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from bayesfric.arrays import Array
from bayesfric.rigs.single_axis.motion import Motion
from bayesfric.rigs.single_axis.weak_form import TestFunction

__all__ = ["force_curvature"]

BESIDE = 3  # half windows, within which a force's second derivative is told


def force_curvature(
    motion: Motion, test: TestFunction, centres: NDArray[np.intp], runs: Array
) -> Array:
    """Return the force's second derivative about each window, shape (W,) [N/s²].

    ∫ φ'' F dt over a window's own samples has the errors of the mean force ∫ φ F dt, with the
    other sign: a row would be explained by its own error, and a compliance be seen in a loud
    force. What lies beside the window tells it; where the axis turns too near, the window's own
    samples do, by weights whose error has no covariance with that of the mean force.

    Parameters
    ----------
    motion : Motion
        A run.
    test : TestFunction
        Of the windows.
    centres : ndarray of int, shape (W,)
        Their middles.
    runs : ndarray, shape (N + 1,)
        Sum of the ways before each sample.
    """
    half, count = test.half, motion.time_s.size
    wide = BESIDE * half
    found = test.over(motion.force, _inside(test, motion.interval_s), centres)
    free = (centres >= wide) & (centres < count - wide)
    inside = centres[free]
    free[free] = np.abs(runs[inside + wide + 1] - runs[inside - wide]) == 2 * wide + 1
    if free.any():
        kernel = _beside(half, wide, motion.interval_s)
        windows = sliding_window_view(motion.force, kernel.size)
        found[free] = windows[centres[free] - wide] @ kernel
    return found


def _inside(test: TestFunction, interval_s: float) -> Array:
    """Return weights of a window's samples that tell a second derivative, (2k + 1,).

    They are those next to φ'' whose error, where samples have white ones, has no covariance with
    that of ∫ φ F dt.
    """
    place = np.arange(-test.half, test.half + 1.0) / test.half
    held = np.stack([np.ones_like(place), place, place**2, test.value])
    wanted = np.array([0.0, 0.0, 2 / (test.half * interval_s) ** 2, 0.0])
    missing = wanted - held @ test.curvature
    return np.asarray(test.curvature + np.linalg.solve(held @ held.T, missing) @ held)


def _beside(half: int, wide: int, interval_s: float) -> Array:
    """Return weights of samples beside a window that tell a second derivative, (2 wide + 1,)."""
    place = np.arange(-wide, wide + 1.0)
    weight = np.where(np.abs(place) > half, (1 - (place / (wide + 1)) ** 2), 0.0)
    time2 = (place / wide) ** 2
    powers = np.stack([time2**power for power in range(3)])
    # No sum and no fourth moment, and 2 of t²: what changes over the window is no curvature.
    numbers = np.linalg.solve(
        (powers * weight) @ powers.T, [0.0, 2 / (wide * interval_s) ** 2, 0.0]
    )
    return np.asarray(weight * (numbers @ powers))

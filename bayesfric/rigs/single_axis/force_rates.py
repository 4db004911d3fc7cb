"""Derivatives of the force in time: for a force that acts late, and the second one around a window.

The rates are those of a force that acts later than logged, or follows its command with a lag. The
second derivative is computed without the errors of the window's mean force.
"""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from bayesfric.arrays import Array, Whole
from bayesfric.rigs.single_axis.decay import decaying
from bayesfric.rigs.single_axis.even_log import EvenLog, sample_noise
from bayesfric.rigs.single_axis.weak_form import TestFunction


def late_rates(
    log: EvenLog, test: TestFunction, centres: NDArray[np.intp], curvature: Array, late_s: float
) -> tuple[Array, Array]:
    """Return the rates of the force for a delay and for a lag, each of shape (W,) [N/s].

    For a delay d, F(t) − F(t − d) = d F'(t − d/2) up to third order, so the rate is taken d/2
    earlier. For a lag, the rate is that of the actuator's force. This is exact even if the command
    changes within the time constant. Errors of the command are in the window's mean force and in
    this rate. Their part of the rate that exceeds that of a delay is proportional to the second
    derivative by the window's own samples. It is replaced by `curvature`, which does not contain
    these errors.

    Parameters
    ----------
    log : EvenLog
        A run; the force before its start is assumed to be that at the start.
    test : TestFunction
        Test function of the windows.
    centres : ndarray of int, shape (W,)
        Middle sample of each window.
    curvature : ndarray, shape (W,)
        Second derivative of the force, without the errors of the mean force [N/s²].
    late_s : float
        Rough delay, or time constant of the lag; a lag is at least one sample long [s].
    """
    ago = 0.5 * late_s / log.interval_s
    lag = max(late_s / log.interval_s, 1.0)

    def rate(force: Array) -> Array:
        return -test.over(force, test.slope, centres)

    value = np.pad(test.value, 1)  # errors outside the window do not matter
    more = following(value, lag) - _earlier(value, ago)
    shared = (test.slope @ more[1:-1]) / (test.curvature @ test.value)
    own = test.over(log.force, test.curvature, centres)
    lagging = rate(following(log.force, lag)) + shared * (own - curvature)
    return rate(_earlier(log.force, ago)), lagging


def _earlier(force: Array, steps: float) -> Array:
    """Return the force some samples ago, shape (N,)."""
    place = np.arange(force.size)
    return np.asarray(np.interp(place - steps, place, force))


def following(force: Array, steps: float) -> Array:
    """Return a first-order lag of a force that is linear between samples, shape (N,).

    Parameters
    ----------
    force : ndarray, shape (N,)
        The force at each sample; before the first sample it is constant.
    steps : float
        Time constant [samples].
    """
    kept = np.exp(-1 / steps)
    mean = (1 - kept) * steps  # mean of the decay over one step
    earlier = np.concatenate([force[:1], force[:-1]])
    driven = (1 - mean) * force + (mean - kept) * earlier
    return decaying(driven, float(kept), float(force[0]))


BESIDE = 3  # half windows from which the second derivative is estimated
MISSED = 2.0  # larger squared differences than errors of the force make, by this factor
EXACT = 3  # degree of the polynomials whose second derivative is exact near a reversal


def force_curvature(
    log: EvenLog, test: TestFunction, centres: NDArray[np.intp], runs: Array
) -> Array:
    """Return the second derivative of the force around each window, shape (W,) [N/s²].

    An estimate by the window's own samples, ∫ φ'' F dt, contains the errors of its mean force with
    opposite sign: a row would be explained by its own error. So samples beside the window are used.
    If the axis reverses among them, friction jumps there, and a compliance responds to the jump.
    Then the window's own samples are used, unless errors of the force explain how they differ from
    the estimate by :func:`_orthogonal`, which does not contain the errors of the mean force.

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
    half = test.half
    wide = BESIDE * half
    before, after = _one_way(np.diff(runs), centres, half, wide)
    curvature = np.zeros(centres.size)
    free = (before == wide) & (after == wide)
    if free.any():
        kernel = _beside(half, wide, log.interval_s)
        windows = sliding_window_view(log.force, kernel.size)
        curvature[free] = windows[centres[free] - wide] @ kernel
    near = np.flatnonzero(~free)
    curvature[near] = _near_reversals(log, test, centres[near], before[near], after[near])
    return curvature


def _near_reversals(
    log: EvenLog, test: TestFunction, centres: Whole, before: Whole, after: Whole
) -> Array:
    """Return the second derivative in windows near a reversal, (V,); see :func:`force_curvature`.

    `before` and `after` are the numbers of samples with the direction of the window, (V,).
    """
    own = test.over(log.force, test.curvature, centres)
    beside, variance = np.zeros(own.size), np.zeros(own.size)
    for extent in {*zip(before.tolist(), after.tolist(), strict=True)}:
        kernel = _orthogonal(test, *extent, log.interval_s)
        mine = (before == extent[0]) & (after == extent[1])
        windows = sliding_window_view(log.force, kernel.size)
        beside[mine] = windows[centres[mine] - extent[0]] @ kernel
        kernel[extent[0] - test.half : extent[0] + test.half + 1] -= test.curvature
        variance[mine] = kernel @ kernel
    by_errors = sample_noise(log.force) ** 2 * float(variance.sum())
    return own if np.sum((own - beside) ** 2) > MISSED * by_errors else beside


def _one_way(way: Array, centres: Whole, half: int, wide: int) -> tuple[Whole, Whole]:
    """Return the number of samples before and after each window's middle with its direction, (W,).

    They are between `half` and `wide`.
    """
    place = np.arange(way.size)
    changes = np.flatnonzero(np.diff(way) != 0)
    first = np.concatenate([[0], changes + 1])
    last = np.concatenate([changes, [way.size - 1]])
    stretch = np.searchsorted(first, place, side="right") - 1
    before = centres - first[stretch[centres]]
    after = last[stretch[centres]] - centres
    return np.clip(before, half, wide), np.clip(after, half, wide)


def _orthogonal(test: TestFunction, before: int, after: int, interval_s: float) -> Array:
    """Return weights for a second derivative that are orthogonal to φ, (before + 1 + after,).

    They are the smallest that are exact for polynomials of degree :data:`EXACT`.
    """
    place = np.arange(-before, after + 1.0) / test.half
    value = np.zeros(place.size)
    value[before - test.half : before + test.half + 1] = test.value / np.abs(test.value).max()
    wanted = np.zeros(EXACT + 2)
    wanted[2] = 2 / (test.half * interval_s) ** 2
    held = np.stack([*(place**power for power in range(EXACT + 1)), value])
    return np.asarray(np.linalg.solve(held @ held.T, wanted) @ held)


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

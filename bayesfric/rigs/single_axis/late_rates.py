"""Rates of change of a force that acts later than logged, or follows its command with a lag."""

import numpy as np
from numpy.typing import NDArray

from bayesfric.arrays import Array
from bayesfric.rigs.single_axis.decay import decaying
from bayesfric.rigs.single_axis.even_log import EvenLog
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

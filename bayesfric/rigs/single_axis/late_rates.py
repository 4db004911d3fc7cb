"""Rates of change of a force that acts later than logged, or follows its command with a lag."""

import numpy as np
import scipy
from numpy.typing import NDArray

from bayesfric.arrays import Array
from bayesfric.rigs.single_axis.even_log import EvenLog
from bayesfric.rigs.single_axis.weak_form import TestFunction


def late_rates(
    log: EvenLog, test: TestFunction, centres: NDArray[np.intp], curvature: Array, late_s: float
) -> tuple[Array, Array]:
    """Return rates by which a delay's and a lag's loss is told, each of shape (W,) [N/s].

    F(t) − F(t − d) is d F'(t − d/2) up to the third order. A lag's loss is told by what the
    actuator gives, exactly: its command may change as fast as the lag is long. What errors of
    the command that are in the window's mean force too have more in the lag's rate would be the
    error of a curvature by the window's own samples: `curvature` stands in its place.

    Parameters
    ----------
    log : EvenLog
        A run; before it the force is taken to have been what it is at the start.
    test : TestFunction
        Of the windows.
    centres : ndarray of int, shape (W,)
        Their middles.
    curvature : ndarray, shape (W,)
        The force's second derivative, apart from the errors of the mean force [N/s²].
    late_s : float
        Delay, or time constant of the lag, roughly; no lag is shorter than a sample [s].
    """
    ago = 0.5 * late_s / log.interval_s
    lag = max(late_s / log.interval_s, 1.0)

    def rate(force: Array) -> Array:
        return -test.over(force, test.slope, centres)

    value = np.pad(test.value, 1)  # no error lies outside of the window
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
    """Return what follows a force, straight between samples, with a time constant, shape (N,).

    Parameters
    ----------
    force : ndarray, shape (N,)
        At every sample; before it is what it was at the first.
    steps : float
        The time constant, in samples.
    """
    kept = np.exp(-1 / steps)
    mean = (1 - kept) * steps  # of what is kept, over one step
    numbers = [1 - mean, mean - kept], [1.0, -kept]
    return np.asarray(scipy.signal.lfilter(*numbers, force, zi=mean * force[:1])[0])

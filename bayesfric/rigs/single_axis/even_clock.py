"""An even clock instead of time stamps that jitter about it.

A host that stamps readings on arrival stamps them too early or too late, although they were taken
evenly. Positions are then smoother on the even clock than on the stamps: on the stamps, each
reading moves by speed times the error of its stamp. If the stamps are right, the same errors make
positions rougher on the even clock. Half of what they would make decides.
"""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from bayesfric.arrays import Array
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES

MOST_OFF = 2.0  # largest deviation of a time stamp from an even clock [intervals]
SMOOTHER = 0.5  # part of the expected difference of roughness that decides for the even clock
CHANCE = 10.0  # and it must be larger than chance by this factor [sd]


def even_clock(time_s: Array, position: Array) -> tuple[Array, float]:
    """Replace time stamps by an even clock if they jitter about it.

    Parameters
    ----------
    time_s, position : ndarray, shape (N,)
        The time stamps, increasing [s], and the positions.

    Returns
    -------
    time_s : ndarray, shape (N,)
        The even clock, or the stamps if they do not jitter [s].
    stamps_sd_s : float
        Rms deviation of the stamps from the even clock; 0 if the stamps are returned [s].
    """
    even, interval = _nearest_clock(time_s)
    off = time_s - even
    size = float(np.sqrt(np.mean(off**2)))
    jitters = size > AXIS_RULES.uneven * interval and np.abs(off).max() < MOST_OFF * interval
    if not jitters or not np.ptp(position) > 0:  # a constant position is smooth on any clock
        return time_s, 0.0
    on_even = _roughness(even, position)
    by_errors = _roughness(even, off * np.gradient(position, even))
    smoother = _roughness(time_s, position) - on_even
    by_chance = np.sqrt(on_even * by_errors / time_s.size)
    if smoother < max(SMOOTHER * by_errors, CHANCE * by_chance):
        return time_s, 0.0
    return even, size


def _nearest_clock(time_s: Array) -> tuple[Array, float]:
    """Return the even clock that is nearest to the stamps, (N,) [s], and its interval [s].

    Readings may be missing, of which the log has no row. A step is then as many intervals long as
    fit best into it. Stamps that jitter by more than half an interval would be miscounted so: the
    count of rows is tried too.
    """
    steps = np.diff(time_s)
    fitting = np.maximum(np.round(steps / np.median(steps)), 1.0)
    clocks = []
    for numbers in (np.ones(steps.size), fitting):
        number = np.concatenate([[0.0], np.cumsum(numbers)])
        line = np.polynomial.Polynomial.fit(number, time_s, 1)
        clocks.append((np.asarray(line(number)), float(line.deriv()(0.0))))
    return min(clocks, key=lambda clock: float(np.sum((time_s - clock[0]) ** 2)))


def _roughness(time_s: Array, position: Array) -> float:
    """Return the mean square deviation of readings from the cubic through four neighbours."""
    times, values = (sliding_window_view(x, 5) for x in (time_s, position))
    around = [0, 1, 3, 4]
    cubic = np.zeros(len(times))
    for k in around:
        others = [j for j in around if j != k]
        weight = np.prod(
            [(times[:, 2] - times[:, j]) / (times[:, k] - times[:, j]) for j in others], axis=0
        )
        cubic += weight * values[:, k]
    return float(np.mean((values[:, 2] - cubic) ** 2))

"""Stray trials: their friction is far from that of other trials of their assembly.

In such a trial the cable may have caught once, or the trial nearly stalled. This is not an effect.
If the trial were kept, it would increase the estimated scatter of all trials.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from bayesfric.arrays import Array, Flags

FEWEST = 3  # least number of trials of an assembly for a median
FAR = 10.0  # distance of a stray trial, relative to the usual distance
MAD = 1.4826  # standard deviation of a normal over its median absolute deviation


def far_from_their_own(deviation: Array, setup: NDArray[Any]) -> Flags:
    """Return which trials are far from the others of their assembly.

    The distance of a trial is that of its relative deviation from the median of its assembly. The
    usual distance is the median absolute deviation, scaled to the standard deviation of a normal
    distribution. An effect increases the usual distance, and a single trial does not.

    Parameters
    ----------
    deviation : ndarray, shape (N,)
        Friction of each trial minus that of the law, relative to the latter.
    setup : ndarray, shape (N,)
        Name of each trial's assembly.
    """
    distance = np.zeros_like(deviation)
    for name in dict.fromkeys(setup):
        own = setup == name
        if np.count_nonzero(own) >= FEWEST:
            distance[own] = np.abs(deviation[own] - np.median(deviation[own]))
    usual = MAD * float(np.median(distance[distance > 0])) if (distance > 0).any() else np.inf
    return np.asarray(distance > FAR * usual)

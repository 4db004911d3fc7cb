"""Trials far from the others of their assembly: the cable caught once, or the trial nearly stalled.

Such a trial is not an effect. If it were kept, it would increase the scatter of all trials.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from bayesfric.arrays import Array, Flags

FEWEST, FAR = 3, 10.0  # trials of an assembly that has a middle; times the usual distance
MAD = 1.4826  # standard deviation of a normal over its median absolute deviation


def far_from_their_own(deviation: Array, setup: NDArray[Any]) -> Flags:
    """Return which trials are far from their assembly.

    Distances are relative deviations from the law less the assembly's median; the usual one is
    their median over all trials, which an effect widens and one trial does not.

    Parameters
    ----------
    deviation : ndarray, shape (N,)
        Of each trial's friction from the law, as a share of it.
    setup : ndarray, shape (N,)
        Names of assemblies.
    """
    distance = np.zeros_like(deviation)
    for name in dict.fromkeys(setup):
        own = setup == name
        if np.count_nonzero(own) >= FEWEST:
            distance[own] = np.abs(deviation[own] - np.median(deviation[own]))
    usual = MAD * float(np.median(distance[distance > 0])) if (distance > 0).any() else np.inf
    return np.asarray(distance > FAR * usual)

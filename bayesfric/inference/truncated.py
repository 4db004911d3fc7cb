"""Draws of normal numbers that a bound holds up: those below it are drawn anew above it."""

import numpy as np
import scipy
from scipy.special import ndtr, ndtri

from bayesfric.arrays import Array

__all__ = ["drawn_above"]

LEAST_DRAWS = 3  # draws, of which a standard deviation is told
FARTHEST = 30.0  # standard deviations of a bound above the mean: beyond, all are at the bound


def drawn_above(draws: Array, least: Array) -> Array:
    """Return draws of a normal density that is cut off at a bound.

    Clipped at the bound, draws of a number that data tell badly would all be alike, and the
    number would seem known. Draws above the bound stay as they are; of those below the ranks
    decide where above the bound they go, so that no further random number is needed.

    Parameters
    ----------
    draws : ndarray, shape (S, …)
        Normal along the first axis.
    least : ndarray
        Bounds, that broadcast to the other axes; −∞ is none.

    Returns
    -------
    ndarray, shape (S, …)
        None below its bound.
    """
    drawn = np.array(draws, dtype=np.float64)
    bound: Array = np.broadcast_to(least, drawn.shape[1:])
    for place in np.ndindex(drawn.shape[1:]):
        column = drawn[(slice(None), *place)]
        below = column < bound[place]
        if not below.any() or len(column) < LEAST_DRAWS or column.std() == 0:
            continue
        mean, sd = float(column.mean()), float(column.std())
        start = min(float((bound[place] - mean) / sd), FARTHEST)
        share = (scipy.stats.rankdata(column[below]) - 0.5) / below.sum()
        # Beyond `start`, by the upper tail: a density far below its bound has little above it.
        drawn[(below, *place)] = mean - sd * ndtri(share * ndtr(-start))
    return np.maximum(drawn, bound)

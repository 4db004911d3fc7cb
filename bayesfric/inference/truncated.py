"""Normal numbers that a bound holds up: what data have below it lies above it.

Where data have a number far below what it can be, something else is wrong by as much, and the
number's own standard deviation says nothing of that: it is widened until the bound is within
:data:`FARTHEST` of the mean.
"""

import numpy as np
import scipy
from scipy.special import log_ndtr, ndtr, ndtri, ndtri_exp

from bayesfric.arrays import Array

LEAST_DRAWS = 3  # draws, of which a standard deviation is told
FARTHEST = 4.0  # standard deviations of a bound above the mean, at the most


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
        sd = _widened(mean, sd, float(bound[place]))
        start = (float(bound[place]) - mean) / sd
        share = (np.argsort(np.argsort(column[below])) + 0.5) / below.sum()
        # Beyond `start`, by the upper tail: a density far below its bound has little above it.
        drawn[(below, *place)] = mean - sd * ndtri(share * ndtr(-start))
    return np.maximum(drawn, bound)


def drawn_above_zero(mean: float, sd: float, count: int, rng: np.random.Generator) -> Array:
    """Return draws of a normal density that is cut off at 0, however far below it the mean is.

    Parameters
    ----------
    mean, sd : float
        Without the cut.
    count : int
        S.
    rng : Generator
        Source of randomness.

    Returns
    -------
    ndarray, shape (S,)
    """
    log_tail = np.log1p(-rng.uniform(size=count)) + log_ndtr(mean / sd)
    return np.asarray(mean - sd * ndtri_exp(log_tail))


def normal_above(mean: float, sd: float, least: float) -> tuple[float, float, Array]:
    """Return what is known of a normal number that is cut off at a bound.

    Parameters
    ----------
    mean, sd : float
        Without the bound.
    least : float
        The bound; −∞ is none.

    Returns
    -------
    mean, sd : float
    quantiles : ndarray, shape (3,)
        At 5, 50 and 95 %.
    """
    sd = _widened(mean, sd, least)
    start = (least - mean) / sd
    centre, width = _moments_above(start)
    quantiles = -ndtri(np.array([0.95, 0.5, 0.05]) * ndtr(-start))
    return mean + sd * centre, sd * width, np.asarray(mean + sd * quantiles)


def normal_cut_to(mean: float, sd: float) -> tuple[float, float]:
    """Return mean and standard deviation of a normal that has given ones once it is cut off at 0.

    Parameters
    ----------
    mean, sd : float
        Of what lies above 0.

    Returns
    -------
    mean, sd : float
        Without the bound, which is no farther above the mean than :data:`FARTHEST`.
    """
    if not sd > 0 or mean > FARTHEST * sd:
        return mean, sd

    def ratio(start: float) -> float:
        centre, width = _moments_above(start)
        return width / (centre - start)

    asked = min(sd / mean, ratio(FARTHEST)) if mean > 0 else ratio(FARTHEST)
    start = scipy.optimize.brentq(lambda x: ratio(x) - asked, -2 * FARTHEST, FARTHEST)
    whole = sd / _moments_above(start)[1]
    return -start * whole, whole


def _moments_above(start: float) -> tuple[float, float]:
    """Return the mean and standard deviation of a standard normal above a bound.

    SciPy's own distributions take 0.3 s to load.
    """
    if start == -np.inf:
        return 0.0, 1.0
    mean = float(np.exp(-0.5 * start * start - log_ndtr(-start)) / np.sqrt(2 * np.pi))
    return mean, float(np.sqrt(1 + start * mean - mean**2))


def _widened(mean: float, sd: float, least: float) -> float:
    """Return a standard deviation by which a bound is no farther above than :data:`FARTHEST`."""
    return max(sd, (least - mean) / FARTHEST)

"""Normal distributions truncated at a lower bound.

If the data put a quantity far below its bound, the model has another error of that size, which the
standard deviation of the quantity does not include. The standard deviation is therefore increased
until the bound is at most :data:`FARTHEST` standard deviations above the mean.
"""

import numpy as np
import scipy
from scipy.special import log_ndtr, ndtr, ndtri, ndtri_exp

from bayesfric.arrays import Array

LEAST_DRAWS = 3  # least draws from which a standard deviation is estimated
FARTHEST = 4.0  # largest distance of a bound above the mean [sd]


def drawn_above(draws: Array, least: Array) -> Array:
    """Return draws of a truncated normal distribution, from those of the normal distribution.

    If draws were clipped at the bound, many draws of an uncertain quantity would be equal, and it
    would seem to be known. Draws above the bound stay as they are. Draws below it are moved above
    it, to quantiles by their ranks, so no further random numbers are needed.

    Parameters
    ----------
    draws : ndarray, shape (S, …)
        Normal draws along the first axis.
    least : ndarray
        Lower bounds, which broadcast to the other axes; −∞ means no bound.

    Returns
    -------
    ndarray, shape (S, …)
        Draws, none of them below its bound.
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
        # The upper tail keeps its digits if the bound is far above the mean.
        drawn[(below, *place)] = mean - sd * ndtri(share * ndtr(-start))
    return np.maximum(drawn, bound)


def drawn_above_zero(mean: float, sd: float, count: int, rng: np.random.Generator) -> Array:
    """Return draws of a normal distribution truncated at 0, for a mean of any sign and size.

    Parameters
    ----------
    mean, sd : float
        Mean and standard deviation without truncation.
    count : int
        Number of draws, S.
    rng : Generator
        Source of randomness.

    Returns
    -------
    ndarray, shape (S,)
    """
    log_tail = np.log1p(-rng.uniform(size=count)) + log_ndtr(mean / sd)
    return np.asarray(mean - sd * ndtri_exp(log_tail))


def normal_above(mean: float, sd: float, least: float) -> tuple[float, float, Array]:
    """Return moments and quantiles of a truncated normal distribution.

    Parameters
    ----------
    mean, sd : float
        Mean and standard deviation without truncation.
    least : float
        Lower bound; −∞ means no bound.

    Returns
    -------
    mean, sd : float
        Mean and standard deviation with truncation.
    quantiles : ndarray, shape (3,)
        Quantiles at 5, 50 and 95 %.
    """
    sd = _widened(mean, sd, least)
    start = (least - mean) / sd
    centre, width = _moments_above(start)
    quantiles = -ndtri(np.array([0.95, 0.5, 0.05]) * ndtr(-start))
    return mean + sd * centre, sd * width, np.asarray(mean + sd * quantiles)


def normal_cut_to(mean: float, sd: float) -> tuple[float, float]:
    """Return the normal distribution whose truncation at 0 has a given mean and sd.

    Parameters
    ----------
    mean, sd : float
        Mean and standard deviation with truncation.

    Returns
    -------
    mean, sd : float
        Mean and standard deviation without truncation. The bound is at most :data:`FARTHEST`
        standard deviations above the mean.
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
    """Return a standard deviation for which the bound is within :data:`FARTHEST` of the mean."""
    return max(sd, (least - mean) / FARTHEST)

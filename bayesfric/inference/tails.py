"""Tail probabilities of families and their inverses, each from its own side.

A probability near 1 has lost the digits of what is missing; the upper tail has them.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import special

from bayesfric.arrays import Array
from bayesfric.families import Beta, Family, Gamma, HalfCauchy, StudentT, TruncatedNormal

Pair = tuple[NDArray[np.floating[Any]], NDArray[np.floating[Any]]]


def from_tails(prior: Family, below: Array, above: Array) -> Pair:
    """Return where a density has a probability below, and where it has one above.

    Parameters
    ----------
    prior : Family
        Student-t, half-Cauchy, gamma, beta or truncated normal.
    below, above : ndarray
        Probabilities, at most a half.
    """
    match prior:
        case StudentT(degrees_of_freedom=freedom, location=location, scale=scale):
            low, high = (special.stdtrit(freedom, tail) for tail in (below, above))
            return location + scale * low, location - scale * high
        case HalfCauchy(scale=scale):
            return scale * np.tan(np.pi / 2 * below), scale / np.tan(np.pi / 2 * above)
        case Gamma(shape=shape, scale=scale):
            return scale * special.gammaincinv(shape, below), scale * special.gammainccinv(
                shape, above
            )
        case Beta(a=a, b=b, high=most):
            return most * special.betaincinv(a, b, below), most * (
                1 - special.betaincinv(b, a, above)
            )
        case TruncatedNormal(mean=mean, sd=sd):
            sign, start, end = _ends(prior)
            if sign < 0:
                below, above = above, below
            # Of the normal that begins at `start` or, turned round, ends there.
            first, last = special.ndtr(start), special.ndtr(end)
            low = special.ndtri(first + below * (last - first))
            high = special.ndtri(last - above * (last - first))
            both = (mean + sign * sd * low, mean + sign * sd * high)
            return both if sign > 0 else both[::-1]
    raise AssertionError(f"{type(prior).__name__} has closed forms of its own")


def to_tails(prior: Family, value: Array) -> Pair:
    """Return the probabilities below and above values.

    Parameters
    ----------
    prior : Family
        As of :func:`from_tails`.
    value : ndarray
        In the parameter's unit.
    """
    match prior:
        case StudentT(degrees_of_freedom=freedom, location=location, scale=scale):
            u = (value - location) / scale
            return special.stdtr(freedom, u), special.stdtr(freedom, -u)
        case HalfCauchy(scale=scale):
            below = 2 / np.pi * np.arctan2(np.maximum(value, 0.0), scale)
            return below, 2 / np.pi * np.arctan2(scale, np.maximum(value, 0.0))
        case Gamma(shape=shape, scale=scale):
            u = np.maximum(value, 0.0) / scale
            return special.gammainc(shape, u), special.gammaincc(shape, u)
        case Beta(a=a, b=b, high=most):
            u = np.clip(value / most, 0.0, 1.0)
            return special.betainc(a, b, u), special.betainc(b, a, 1 - u)
        case TruncatedNormal(mean=mean, sd=sd):
            sign, start, end = _ends(prior)
            first, last = special.ndtr(start), special.ndtr(end)
            probability = special.ndtr(np.clip(sign * (value - mean) / sd, start, end))
            tails = ((probability - first) / (last - first), (last - probability) / (last - first))
            return tails if sign > 0 else tails[::-1]
    raise AssertionError(f"{type(prior).__name__} has closed forms of its own")


def _ends(prior: TruncatedNormal) -> tuple[int, float, float]:
    """Return bounds in standard deviations, turned round where both are above the mean."""
    low = (prior.lowest - prior.mean) / prior.sd
    high = np.inf if prior.high is None else (prior.high - prior.mean) / prior.sd
    return (-1, -high, -low) if low > 0 else (1, low, high)

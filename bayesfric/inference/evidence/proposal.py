"""A Student-t fitted to draws, from which the evidence of a density is estimated."""

from collections.abc import Callable
from typing import Protocol, cast

import numpy as np
from numpy.typing import NDArray
from scipy import stats

__all__ = ["LogDensity", "Proposal", "evaluate", "fit_proposal"]

Array = NDArray[np.float64]
LogDensity = Callable[[Array], Array]

POINTS_A_CALL = 128  # of a log density: enough to vectorise, and small enough for a cache
FREEDOMS = (4, 8, 16, 32, 64, 1024)


class _Frozen(Protocol):
    """What is used of a frozen distribution."""

    def logpdf(self, x: Array) -> Array: ...

    def rvs(self, size: int, random_state: np.random.Generator) -> Array: ...


class Proposal:
    """A normalised multivariate Student-t.

    Parameters
    ----------
    mean : ndarray, shape (D,)
        Its mean.
    covariance : ndarray, shape (D, D)
        Its covariance.
    freedom : int
        Degrees of freedom, above 2.
    """

    def __init__(self, mean: Array, covariance: Array, freedom: int) -> None:
        self.freedom = freedom
        self._size = mean.size
        shape = covariance * (freedom - 2) / freedom
        self._mean, self._unit = mean, np.sqrt(np.diag(shape))
        # Whether it is singular is asked of its correlations: widths may differ by any factor.
        correlation = shape / np.outer(self._unit, self._unit)
        self._white = cast(_Frozen, stats.multivariate_t(None, correlation, df=freedom))
        student = stats.multivariate_t(mean, shape, df=freedom, allow_singular=True)
        self._student = cast(_Frozen, student)

    def draw(self, size: int, rng: np.random.Generator) -> Array:
        """Return draws, shape (size, D)."""
        return self._student.rvs(size, random_state=rng).reshape(size, self._size)

    def log_density(self, points: Array) -> Array:
        """Return the log density of points of shape (W, D), shape (W,)."""
        # One point would come back as a number.
        density = self._white.logpdf((points - self._mean) / self._unit).reshape(len(points))
        return np.asarray(density - np.log(self._unit).sum())


def fit_proposal(draws: Array) -> Proposal:
    """Fit mean, covariance and tails to draws.

    Parameters
    ----------
    draws : ndarray, shape (N, D)
        Of the density.

    Returns
    -------
    Proposal
        With the moments of the draws and, of :data:`FREEDOMS`, the degrees of
        freedom under which the draws are most likely: a proposal with the wrong
        tails overlaps less, in many dimensions much less.
    """
    mean, covariance = draws.mean(axis=0), np.atleast_2d(np.cov(draws, rowvar=False))
    candidates = [Proposal(mean, covariance, freedom) for freedom in FREEDOMS]
    return max(candidates, key=lambda proposal: float(proposal.log_density(draws).sum()))


def evaluate(log_density: LogDensity, points: Array) -> Array:
    """Return log densities of many points, some at a time.

    Parameters
    ----------
    log_density : callable
        Points of shape (W, D) to log densities of shape (W,).
    points : ndarray, shape (N, D)
        Any number of them.

    Returns
    -------
    ndarray, shape (N,)
        Finite, or −inf where the density is zero.

    Raises
    ------
    ValueError
        A log density is NaN or +inf.
    """
    parts = [
        log_density(points[start : start + POINTS_A_CALL])
        for start in range(0, len(points), POINTS_A_CALL)
    ]
    values = np.concatenate(parts)
    if not (values < np.inf).all():
        raise ValueError("a log density is NaN or +inf")
    return values

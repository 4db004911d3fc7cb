"""The Bayes factor of a point against the model around it, from draws.

Savage and Dickey: where the narrow model fixes some parameters of the wide one, and
its prior for the rest is the wide one's prior given those values, the evidence of the
narrow model over the wide one's is the posterior density of the wide model at the
point over its prior density there.

The density of the draws is a normal in coordinates that the Yeo–Johnson power takes
skewness from, times what a kernel estimate says the normal is wrong by (Hjort and
Glad). Beyond the draws there is no such correction, and nothing to rely on.

References
----------
J. M. Dickey, "The weighted likelihood ratio, linear hypotheses on normal location
parameters", Annals of Mathematical Statistics 42 (1971).
N. L. Hjort, I. K. Glad, "Nonparametric density estimation with a parametric start",
Annals of Statistics 23 (1995).
I.-K. Yeo, R. A. Johnson, "A new family of power transformations to improve normality
or symmetry", Biometrika 87 (2000).
"""

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from bayesfric.inference.evidence.record import Evidence

__all__ = ["savage_dickey"]

Array = NDArray[np.float64]

BLOCKS = 20  # of draws; the error comes from leaving out each in turn
LEAST_DRAWS = 400
LEAST_NEAR = 50.0  # draws within the kernel, below which its correction is noise


def savage_dickey(draws: Array, point: Array, log_prior: float) -> Evidence:
    """Estimate the log Bayes factor of a point against the model of the draws.

    The point must be inside the space of the draws: at an edge, such as a scale of
    zero, compare evidences instead.

    Parameters
    ----------
    draws : ndarray, shape (N, d)
        Posterior draws of the parameters that the point fixes, in the order in which
        they were drawn; at least 400.
    point : ndarray, shape (d,)
        Their values.
    log_prior : float
        Log prior density of the wide model at the point, in the same coordinates.

    Returns
    -------
    Evidence
        Log evidence of the narrow model less that of the wide one. Where the point
        lies beyond the draws the value follows the tail of the transformed normal,
        which the draws cannot confirm: the error is infinite.

    Raises
    ------
    ValueError
        Too few draws, shapes that do not fit, or draws that are not finite.
    """
    count, size = draws.shape
    if count < LEAST_DRAWS or point.shape != (size,) or not np.isfinite(draws).all():
        raise ValueError(
            f"draws {draws.shape} must be finite, at least {LEAST_DRAWS}, and fit the "
            f"point {point.shape}"
        )
    straight, place, log_jacobian = _straightened(draws, point)
    if _kernel(straight, place)[0].sum() < LEAST_NEAR:
        value = _log_normal(straight, place) + log_jacobian - log_prior
        return Evidence(value, float("inf"), "Savage–Dickey ratio, beyond the draws")
    value = _log_density(straight, place) + log_jacobian - log_prior
    # The powers stay: the correction makes up for what they are wrong by.
    without = [
        _log_density(np.delete(straight, block, axis=0), place)
        for block in np.array_split(np.arange(count), BLOCKS)
    ]
    error = np.sqrt((BLOCKS - 1) * np.var(without))
    return Evidence(value, float(error), "Savage–Dickey ratio")


def _straightened(draws: Array, point: Array) -> tuple[Array, Array, float]:
    """Return draws and point without skewness, and the log Jacobian at the point."""
    middle, width = draws.mean(axis=0), draws.std(axis=0)
    scaled, place = (draws - middle) / width, (point - middle) / width
    straight, moved = np.empty_like(scaled), np.empty_like(place)
    log_jacobian = -float(np.log(width).sum())
    for i in range(point.size):
        straight[:, i], power = stats.yeojohnson(scaled[:, i])
        moved[i] = stats.yeojohnson(place[i : i + 1], power)[0]
        log_jacobian += float((power - 1) * np.sign(place[i]) * np.log1p(abs(place[i])))
    return straight, moved, log_jacobian


def _moments(draws: Array) -> tuple[Array, Array]:
    return draws.mean(axis=0), np.atleast_2d(np.cov(draws, rowvar=False))


def _log_normal(draws: Array, point: Array) -> float:
    mean, covariance = _moments(draws)
    return float(stats.multivariate_normal(mean, covariance).logpdf(point))


def _kernel(draws: Array, point: Array) -> tuple[Array, float]:
    """Return the kernel at the point, 1 at its peak, for each draw; and its width squared."""
    _, covariance = _moments(draws)
    count, size = draws.shape
    width2 = float(count ** (-2 / (size + 4)))  # Scott's rule, in units of the covariance
    kernel = stats.multivariate_normal(point, width2 * covariance)
    return np.exp(kernel.logpdf(draws) - kernel.logpdf(point)), width2


def _log_density(draws: Array, point: Array) -> float:
    """Return that of the normal, times a kernel estimate over the normal smoothed as much."""
    kernels, width2 = _kernel(draws, point)
    mean, covariance = _moments(draws)
    peak = stats.multivariate_normal(point, width2 * covariance).logpdf(point)
    smoothed = stats.multivariate_normal(mean, (1 + width2) * covariance).logpdf(point)
    return _log_normal(draws, point) + float(np.log(kernels.mean()) + peak - smoothed)

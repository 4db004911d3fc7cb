"""The log evidence without draws: importance sampling around the mode.

The normal approximation gives a Student-t to draw from, with tails that are heavier
than those of most densities; the weights are Pareto-smoothed. Meant to screen: it
takes a fraction of a second and says when it is not to be relied on.

References
----------
A. Vehtari, D. Simpson, A. Gelman, Y. Yao, J. Gabry, "Pareto smoothed importance
sampling", Journal of Machine Learning Research 25 (2024).
J. Geweke, "Bayesian inference in econometric models using Monte Carlo integration",
Econometrica 57 (1989).
"""

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp

from bayesfric.inference.diagnostics import smooth_weights
from bayesfric.inference.evidence.proposal import LogDensity, Proposal, evaluate
from bayesfric.inference.evidence.record import Evidence
from bayesfric.inference.laplace import Laplace

__all__ = ["laplace_draws", "reliable_draws"]

Array = NDArray[np.float64]

FREEDOM = 5
INFLATION = 1.3  # of the covariance: weights suffer less from too wide than from too narrow
GOOD_K, LIMIT_K = 0.5, 0.7  # below the first the weights have a variance
LEAST_SIZE = 200
SIZES = 2000, 4000  # of a sample, and of another where the first is not to be relied on


def laplace_draws(
    log_density: LogDensity,
    laplace: Laplace,
    seed: int | np.random.Generator,
    size: int = 2000,
) -> tuple[Evidence, Array]:
    """Estimate the log evidence around one mode, and resample the points by their weights.

    Where the tail of the weights is bad, the proposal is fitted anew to the weighted
    sample, once, and a fresh sample drawn. A mode far from this one cannot be noticed.

    Parameters
    ----------
    log_density : callable
        Unnormalised; points of shape (W, D) to log densities of shape (W,).
    laplace : Laplace
        Its normal approximation.
    seed : int or Generator
        Of the sample.
    size : int
        Points of a sample, at least 200.

    Returns
    -------
    evidence : Evidence
        Of infinite error where the Pareto k is above 0.7.
    draws : ndarray, shape (size, D)
        Of the density, some of them more than once; as good as the evidence is.

    Raises
    ------
    ValueError
        Too small a sample, or the density is zero at all of its points.
    """
    if size < LEAST_SIZE:
        raise ValueError(f"a sample of {size} points; at least {LEAST_SIZE} are needed")
    rng = np.random.default_rng(seed)
    proposal = Proposal(laplace.mode, INFLATION * laplace.covariance, FREEDOM)
    points, log_weights, k = _sample(log_density, proposal, size, rng)
    if k > GOOD_K:
        proposal = _refitted(points, log_weights)
        points, log_weights, k = _sample(log_density, proposal, size, rng)
    total = logsumexp(log_weights)
    # Relative variance of the mean weight.
    variance = np.exp(logsumexp(2 * log_weights) - 2 * total) - 1 / size
    error = float(np.sqrt(max(variance, 0.0))) if k <= LIMIT_K else float("inf")
    evidence = Evidence(float(total - np.log(size)), error, "importance sampling", k)
    # Systematic resampling: each point as often as its weight says, to within one.
    ladder = (np.arange(size) + rng.uniform()) / size
    chosen = np.searchsorted(np.cumsum(np.exp(log_weights - total)), ladder)
    return evidence, points[np.minimum(chosen, size - 1)]


def reliable_draws(
    log_density: LogDensity, laplace: Laplace, seed: int
) -> tuple[Evidence, Array] | None:
    """Estimate and resample, again with more points where the first sample is unreliable.

    Where the tails of a density are barely light enough, one sample in eight has a Pareto k
    above its limit by chance.

    Parameters
    ----------
    log_density, laplace, seed
        As for :func:`laplace_draws`.

    Returns
    -------
    tuple of (Evidence, ndarray) or None
        As of :func:`laplace_draws`; None where neither sample is reliable.
    """
    for size in SIZES:
        found, draws = laplace_draws(log_density, laplace, seed, size)
        if found.reliable:
            return found, draws
    return None


def _sample(
    log_density: LogDensity, proposal: Proposal, size: int, rng: np.random.Generator
) -> tuple[Array, Array, float]:
    """Return points, smoothed log weights and Pareto k."""
    points = proposal.draw(size, rng)
    log_weights = evaluate(log_density, points) - proposal.log_density(points)
    if not np.isfinite(log_weights).any():
        raise ValueError("the density is zero all around the mode")
    return points, *smooth_weights(log_weights)


def _refitted(points: Array, log_weights: Array) -> Proposal:
    """Return a proposal with the moments of the weighted sample."""
    weights = np.exp(log_weights - logsumexp(log_weights))
    # Few points may hold most of the weight, and their covariance would be singular:
    # none counts for more than the root of the sample.
    weights = np.minimum(weights, 1 / np.sqrt(len(points)))
    mean = np.average(points, axis=0, weights=weights)
    covariance = np.atleast_2d(np.cov(points, rowvar=False, aweights=weights))
    return Proposal(mean, INFLATION * covariance, FREEDOM)

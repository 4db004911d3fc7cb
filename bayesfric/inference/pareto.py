"""Importance weights with their largest smoothed, as Pareto quantiles (PSIS).

Written out, since ArviZ's own takes two seconds and 60 MiB to load, which a diagnosis and a
claim have no other use for; `tests/inference/test_diagnostics.py` holds it against that.
"""

import numpy as np
from scipy.special import logsumexp

from bayesfric.arrays import Array

LEAST_WEIGHTS = 25  # the tail is a fifth of them, and needs five
SHAPE, SHAPE_WEIGHT = 0.5, 10  # prior of the shape: a mean, and how many weights it counts for
NEGLIGIBLE = 10 * np.finfo(np.float64).eps  # of the probability of a point of the grid


def smooth_weights(log_weights: Array) -> tuple[Array, float]:
    """Smooth the largest importance weights by a Pareto distribution fitted to them.

    Parameters
    ----------
    log_weights : ndarray, shape (N,)
        Unnormalised; −inf is a weight of zero.

    Returns
    -------
    log_weights : ndarray, shape (N,)
        Smoothed, on the scale of those given.
    pareto_k : float
        Shape of the tail: above 0.7 (`SamplingRules.pareto_k`) the weights are not to be relied on.
        0 where the largest weights are all the same, inf where fewer than 25 are not zero or
        where a quarter of the tail is one and the same draw or nothing beside the largest.

    References
    ----------
    A. Vehtari, D. Simpson, A. Gelman, Y. Yao, J. Gabry, "Pareto smoothed importance
    sampling", Journal of Machine Learning Research 25 (2024).
    """
    finite = np.flatnonzero(np.isfinite(log_weights))
    order = finite[np.argsort(log_weights[finite])]
    ordered = log_weights[order]
    if ordered.size < LEAST_WEIGHTS:
        return log_weights, float("inf")
    if ordered[-1] - ordered[-5] < 1e-12:
        return log_weights, 0.0  # no tail to fit
    tail = int(min(ordered.size / 5, 3 * np.sqrt(ordered.size)))
    if ordered[tail // 4 - tail] == ordered[-tail]:
        return log_weights, float("inf")  # a quarter of the tail is one draw
    beside = np.exp(ordered[-tail - 1 :] - ordered[-1])
    if beside[int(tail / 4 + 0.5)] == beside[0]:
        return log_weights, float("inf")  # a quarter of the tail vanishes beside its largest
    # Quantiles of a tail that spans the range of doubles overflow; they are cut to the largest.
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        k, scale = _fitted(beside[1:] - beside[0])
        rank = (np.arange(tail) + 0.5) / tail
        quantiles = beside[0] + scale * np.expm1(-k * np.log1p(-rank)) / k
        largest = np.minimum(np.log(quantiles), 0.0)
    if not (np.isfinite(k) and scale > 0 and np.isfinite(largest).all()):
        return log_weights, float("inf")
    smoothed = log_weights.copy()
    smoothed[order[-tail:]] = largest + ordered[-1]
    return smoothed, k


def _fitted(beyond: Array) -> tuple[float, float]:
    """Return shape and scale of the generalised Pareto distribution of ascending numbers.

    The posterior mean over a grid of −shape/scale; J. Zhang, M. A. Stephens, "A new and efficient
    estimation method for the generalized Pareto distribution", Technometrics 51 (2009).
    """
    count = beyond.size
    points = 30 + int(np.sqrt(count))
    grid = 1 - np.sqrt(points / (np.arange(points) + 0.5))
    grid = grid / (3 * beyond[int(count / 4 + 0.5) - 1]) + 1 / beyond[-1]
    shapes = np.log1p(-grid[:, None] * beyond).mean(axis=1)
    log_density = count * (np.log(-grid / shapes) - shapes - 1)
    weights = np.exp(log_density - logsumexp(log_density))
    weights[weights < NEGLIGIBLE] = 0.0
    mean = float(grid @ weights / weights.sum())
    k = float(np.log1p(-mean * beyond).mean())
    return (count * k + SHAPE_WEIGHT * SHAPE) / (count + SHAPE_WEIGHT), -k / mean

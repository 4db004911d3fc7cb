"""Pareto-smoothed importance sampling (PSIS): the largest weights become Pareto quantiles.

ArviZ has this method too, but takes two seconds and 60 MiB to load, and a diagnosis or a claim
needs nothing else of it. `tests/inference/test_diagnostics.py` compares the two.
"""

import numpy as np
from scipy.special import logsumexp

from bayesfric.arrays import Array

LEAST_WEIGHTS = 25  # a tail has a fifth of the weights, and at least five
SHAPE, SHAPE_WEIGHT = 0.5, 10  # mean of the shape's prior, and the number of weights it equals
NEGLIGIBLE = 10 * np.finfo(np.float64).eps  # probability of a grid point that is ignored


def smooth_weights(log_weights: Array) -> tuple[Array, float]:
    """Smooth the largest importance weights by a Pareto distribution fitted to them.

    Parameters
    ----------
    log_weights : ndarray, shape (N,)
        Unnormalised log weights; −inf is a weight of zero.

    Returns
    -------
    log_weights : ndarray, shape (N,)
        Smoothed log weights, on the scale of the given ones.
    pareto_k : float
        Shape of the tail. Above 0.7 (`SamplingRules.pareto_k`) the weights are unreliable. It is 0
        if the largest weights are equal. It is inf if fewer than 25 weights are positive, or if a
        quarter of the tail has equal weights or is negligible against the largest weight.

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
        return log_weights, float("inf")  # a quarter of the tail has equal weights
    beside = np.exp(ordered[-tail - 1 :] - ordered[-1])
    if beside[int(tail / 4 + 0.5)] == beside[0]:
        return log_weights, float("inf")  # a quarter of the tail is negligible
    # Quantiles of a very long tail overflow; they are limited to the largest weight.
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
    """Return shape and scale of a generalised Pareto distribution fitted to ascending numbers.

    The estimate is the posterior mean over a grid of −shape/scale: J. Zhang, M. A. Stephens, "A new
    and efficient estimation method for the generalized Pareto distribution", Technometrics 51
    (2009).
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

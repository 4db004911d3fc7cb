"""Draws given more data, from draws given the first data alone.

Let x be the parameters of the first data, of which there are draws, and y those of more data only.
Each draw of x is combined with a point y from a proposal. Its weight is the density of y and of
more data given x, divided by the density of the proposal at y. The likelihood of the first data is
not evaluated again. The method is reliable if more data say little of x beyond the first data;
Pareto k and the effective sample size show whether they do.

References
----------
N. Chopin, "A sequential particle filter method for static models", Biometrika 89 (2002).
A. Vehtari, D. Simpson, A. Gelman, Y. Yao, J. Gabry, "Pareto smoothed importance
sampling", Journal of Machine Learning Research 25 (2024).
"""

from collections.abc import Callable

import numpy as np
from scipy.special import logsumexp

from bayesfric.arrays import Array
from bayesfric.inference.evidence.importance import LEAST_FOR_A_MEAN, TRIES
from bayesfric.inference.laplace import Laplace
from bayesfric.inference.pareto import smooth_weights
from bayesfric.inference.proposals import Chart, Proposal, importance_points, resampled
from bayesfric.inference.sampling_rules import SAMPLING_RULES


def draws_with_more_data(
    log_density: Callable[[Array, Array], Array],
    first: Array,
    centre: Array,
    laplace: Laplace,
    seed: int,
    chart: Chart,
    size: int,
) -> Array | None:
    """Draw from the posterior of x and y given all data.

    Parameters
    ----------
    log_density : callable
        From points x of shape (W, K) and y of shape (W, L) to the log density of y and of more data
        given x, shape (W,); −inf where it is zero.
    first : ndarray, shape (S, K)
        Draws of x given the first data, in random order.
    centre : ndarray, shape (K,)
        A typical x, at which the first proposal is fitted.
    laplace : Laplace
        Normal approximation of the density of y at `centre`.
    seed : int
        Seed of the samples.
    chart : Chart
        Coordinates of y in which proposals are fitted.
    size : int
        Points of a sample; each draw of x is used about equally often.

    Returns
    -------
    ndarray, shape (size, K + L), or None
        Draws in random order, some of them repeated; None if the weights are unreliable.
    """
    rng = np.random.default_rng(seed)

    def at_centre(y: Array) -> Array:
        return log_density(np.broadcast_to(centre, (len(y), centre.size)), y)

    fitted_to = importance_points(at_centre, laplace, chart, rng, LEAST_FOR_A_MEAN)
    if fitted_to is None:
        return None
    for _ in range(TRIES):
        proposal = Proposal.around(fitted_to, chart)
        x = first[rng.permutation(np.arange(size) % len(first))]
        y, possible = proposal.draw(size, rng)
        x, y = x[possible], y[possible]
        log_weights, k = smooth_weights(log_density(x, y) - proposal.log_density(y))
        if not np.isfinite(log_weights).any():
            return None
        weights = np.exp(log_weights - logsumexp(log_weights))
        if k <= SAMPLING_RULES.pareto_k and 1 / (weights**2).sum() > LEAST_FOR_A_MEAN * size:
            return rng.permutation(np.hstack([x, y])[resampled(weights, size, rng)])
        fitted_to = y[resampled(np.minimum(weights, 1 / np.sqrt(size)), size, rng)]
    return None

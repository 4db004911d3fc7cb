"""The log evidence by importance sampling around the mode, and draws of the density.

The proposal is fitted to importance samples of its own until most of a sample counts
(:func:`bayesfric.inference.proposals.importance_points`); the sample that is weighed is drawn
afterwards, since one that has been chosen by its weights is biased. Its weights are
Pareto-smoothed. No chain has to be run, and where the weights are not to be relied on that
is seen.

References
----------
A. Vehtari, D. Simpson, A. Gelman, Y. Yao, J. Gabry, "Pareto smoothed importance
sampling", Journal of Machine Learning Research 25 (2024).
J. Geweke, "Bayesian inference in econometric models using Monte Carlo integration",
Econometrica 57 (1989).
O. Cappé, A. Guillin, J.-M. Marin, C. P. Robert, "Population Monte Carlo", Journal of
Computational and Graphical Statistics 13 (2004).
"""

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp

from bayesfric.inference.diagnostics import smooth_weights
from bayesfric.inference.evidence.record import Evidence
from bayesfric.inference.laplace import Laplace
from bayesfric.inference.proposals import (
    SAMPLING_SPACE,
    Chart,
    LogDensity,
    Proposal,
    importance_points,
)

__all__ = ["importance_draws"]

Array = NDArray[np.float64]

SIZE = 4000
LIMIT_K = 0.7  # of the Pareto shape, above which weights are not to be relied on


def importance_draws(
    log_density: LogDensity,
    laplace: Laplace,
    seed: int,
    chart: Chart = SAMPLING_SPACE,
    size: int = SIZE,
) -> tuple[Evidence, Array] | None:
    """Estimate the log evidence around one mode, and resample the points by their weights.

    A mode far from this one cannot be noticed.

    Parameters
    ----------
    log_density : callable
        Unnormalised; points of shape (W, D) to log densities of shape (W,), −inf where it
        is zero.
    laplace : Laplace
        Its normal approximation.
    seed : int
        Of the samples.
    chart : Chart
        In which the proposal is fitted.
    size : int
        Points of the sample that is weighed.

    Returns
    -------
    evidence : Evidence
        With its standard error.
    draws : ndarray, shape (size, D)
        Of the density, some of them more than once; in no order.

    None where no sample around the mode is to be relied on.
    """
    rng = np.random.default_rng(seed)
    points = importance_points(log_density, laplace, chart, rng)
    if points is None:
        return None
    proposal = Proposal.around(points, chart)
    z, possible = proposal.draw(size, rng)
    z = z[possible]
    log_weights, k = smooth_weights(log_density(z) - proposal.log_density(z))
    if not k <= LIMIT_K:
        return None
    total = logsumexp(log_weights)
    # Points outside of the sampling space are draws too, of weight zero.
    variance = np.exp(logsumexp(2 * log_weights) - 2 * total) - 1 / size
    error = float(np.sqrt(max(variance, 0.0)))
    evidence = Evidence(float(total - np.log(size)), error, "importance sampling", k)
    # Systematic resampling: each point as often as its weight says, to within one.
    ladder = (np.arange(size) + rng.uniform()) / size
    chosen = np.searchsorted(np.cumsum(np.exp(log_weights - total)), ladder)
    return evidence, rng.permutation(z[np.minimum(chosen, len(z) - 1)])

"""The log evidence by importance sampling around the mode, and draws of the density.

The proposal is fitted to a series of importance samples, until the effective size of a sample is
large enough (:func:`bayesfric.inference.proposals.importance_points`). The estimate uses a new
sample, because one that was selected by its weights would be biased. It is drawn from a mixture of
this proposal and a wider one, and its weights are Pareto-smoothed. No chain is needed, and Pareto k
shows whether the weights are reliable.

References
----------
A. Vehtari, D. Simpson, A. Gelman, Y. Yao, J. Gabry, "Pareto smoothed importance
sampling", Journal of Machine Learning Research 25 (2024).
J. Geweke, "Bayesian inference in econometric models using Monte Carlo integration",
Econometrica 57 (1989).
T. Hesterberg, "Weighted average importance sampling and defensive mixture distributions",
Technometrics 37 (1995).
O. Cappé, A. Guillin, J.-M. Marin, C. P. Robert, "Population Monte Carlo", Journal of
Computational and Graphical Statistics 13 (2004).
"""

import numpy as np
from scipy.special import logsumexp

from bayesfric.arrays import Array
from bayesfric.inference.evidence.record import Evidence
from bayesfric.inference.laplace import Laplace
from bayesfric.inference.pareto import smooth_weights
from bayesfric.inference.proposals import (
    LEAST_EFFECTIVE,
    POINTS,
    SAMPLING_SPACE,
    Chart,
    LogDensity,
    Proposal,
    importance_points,
    resampled,
)
from bayesfric.inference.sampling_rules import SAMPLING_RULES

SIZE = 4000  # points of a sample
LEAST_FOR_A_MEAN = 0.1  # least relative effective size for a mean, which needs less than evidence
TRIES = 3  # samples, each from a proposal fitted to the previous one
DEFENSIVE, WIDER = 0.1, 2.0
"""Share of the sample from a wider proposal, which bounds the weights in the tails, and the ratio
of the widths."""


def importance_draws(
    log_density: LogDensity,
    laplace: Laplace,
    seed: int,
    chart: Chart = SAMPLING_SPACE,
    size: int = SIZE,
    least_effective: float = LEAST_EFFECTIVE,
    points: int = POINTS,
) -> tuple[Evidence, Array] | None:
    """Estimate the log evidence around one mode, and resample the points by their weights.

    A mode far from this one is missing in the estimate.

    Parameters
    ----------
    log_density : callable
        Unnormalised log density, from points of shape (W, D) to shape (W,); −inf where the
        density is zero.
    laplace : Laplace
        Normal approximation of the density.
    seed : int
        Seed of the samples.
    chart : Chart
        Coordinates in which the proposal is fitted.
    size : int
        Points of the sample from which the evidence is estimated.
    least_effective : float
        Least relative effective size of the sample to which the proposal is fitted.
    points : int
        Points of that sample.

    Returns
    -------
    evidence : Evidence
        The estimate with its standard error.
    draws : ndarray, shape (size, D)
        Draws of the density in random order, some of them repeated.

    The result is None if no sample around the mode is reliable.
    """
    rng = np.random.default_rng(seed)
    fitted_to = importance_points(log_density, laplace, chart, rng, least_effective, points)
    for _ in range(TRIES):
        if fitted_to is None:
            return None
        z, log_weights, k = _weighed(log_density, Proposal.around(fitted_to, chart), size, rng)
        total = logsumexp(log_weights)
        weights = np.exp(log_weights - total)
        if k <= SAMPLING_RULES.pareto_k:
            break
        fitted_to = z[resampled(np.minimum(weights, 1 / np.sqrt(size)), size, rng)]
    else:
        return None
    # Points outside the sampling space are part of the sample, with weight zero.
    error = float(np.sqrt(max((weights**2).sum() - 1 / size, 0.0)))
    evidence = Evidence(float(total - np.log(size)), error, "importance sampling", k)
    return evidence, rng.permutation(z[resampled(weights, size, rng)])


def _weighed(
    log_density: LogDensity, fitted: Proposal, size: int, rng: np.random.Generator
) -> tuple[Array, Array, float]:
    """Draw from the mixture of proposals; return points, smoothed log weights and Pareto k."""
    wider = Proposal(fitted.student.wider(WIDER), fitted.chart)
    parts = (1 - DEFENSIVE, fitted), (DEFENSIVE, wider)
    counts = rng.multinomial(size, [share for share, _ in parts])
    drawn = [proposal.draw(count, rng) for count, (_, proposal) in zip(counts, parts, strict=True)]
    z = np.concatenate([points[possible] for points, possible in drawn])
    proposed = np.logaddexp(*(np.log(share) + proposal.log_density(z) for share, proposal in parts))
    return z, *smooth_weights(log_density(z) - proposed)

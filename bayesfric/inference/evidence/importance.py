"""The log evidence by importance sampling around the mode, and draws of the density.

The proposal is fitted to importance samples of its own until much of a sample counts
(:func:`bayesfric.inference.proposals.importance_points`); the sample that is weighed is drawn
afterwards, since one that has been chosen by its weights is biased. It is of a mixture of that
proposal and a wider one, and its weights are Pareto-smoothed. No chain has to be run, and where
the weights are not to be relied on that is seen.

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

SIZE = 4000
LEAST_FOR_A_MEAN = 0.1  # of a sample; a mean over draws takes fewer than an evidence
TRIES = 3  # each from a proposal that is fitted to the sample before
DEFENSIVE, WIDER = 0.1, 2.0
"""Share of the sample that is drawn from a wider proposal, which bounds the weights in the tails;
how much wider."""


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
    least_effective : float
        Share that has to count of the sample that the proposal is fitted to.
    points : int
        Of that sample.

    Returns
    -------
    evidence : Evidence
        With its standard error.
    draws : ndarray, shape (size, D)
        Of the density, some of them more than once; in no order.

    None where no sample around the mode is to be relied on.
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
    # Points outside of the sampling space are draws too, of weight zero.
    error = float(np.sqrt(max((weights**2).sum() - 1 / size, 0.0)))
    evidence = Evidence(float(total - np.log(size)), error, "importance sampling", k)
    return evidence, rng.permutation(z[resampled(weights, size, rng)])


def _weighed(
    log_density: LogDensity, fitted: Proposal, size: int, rng: np.random.Generator
) -> tuple[Array, Array, float]:
    """Draw from a proposal and a wider one; return points, smoothed log weights, Pareto k."""
    wider = Proposal(fitted.student.wider(WIDER), fitted.chart)
    parts = (1 - DEFENSIVE, fitted), (DEFENSIVE, wider)
    counts = rng.multinomial(size, [share for share, _ in parts])
    drawn = [proposal.draw(count, rng) for count, (_, proposal) in zip(counts, parts, strict=True)]
    z = np.concatenate([points[possible] for points, possible in drawn])
    proposed = np.logaddexp(*(np.log(share) + proposal.log_density(z) for share, proposal in parts))
    return z, *smooth_weights(log_density(z) - proposed)

"""Leave-one-group-out predictive densities, from draws of the posterior of all data.

The groups of a joint normal density are not independent given the parameters θ. The density of a
group g given all others is therefore p(y_g | y_−g, θ). The relation

    p(θ | y_−g) ∝ p(θ | y) / p(y_g | y_−g, θ)

holds without independence. So draws of p(θ | y) with weights 1/p(y_g | y_−g, θ) are draws of the
posterior without g, and the weighted mean of p(y_g | y_−g, θ) is the leave-one-out density. The
weights are Pareto-smoothed.

If the weights fail, the group informs θ so strongly that draws of p(θ | y) cannot be used. The same
relation still gives the density without the group, up to a constant. Its mode is then found from
that of all data, and the density is sampled by importance sampling around it (an exact refit).

References
----------
P.-C. Bürkner, J. Gabry, A. Vehtari, "Efficient leave-one-out cross-validation for
Bayesian non-factorized normal and Student-t models", Computational Statistics 36
(2021).
A. Vehtari, D. Simpson, A. Gelman, Y. Yao, J. Gabry, "Pareto smoothed importance
sampling", Journal of Machine Learning Research 25 (2024).
M. Magnusson, M. R. Andersen, J. Jonasson, A. Vehtari, "Leave-one-out cross-validation
for Bayesian model comparison in large data", AISTATS (2020).
T. Sivula, M. Magnusson, A. A. Matamoros, A. Vehtari, "Uncertainty in Bayesian
leave-one-out cross-validation based model comparison", arXiv:2008.10296.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp

from bayesfric.arrays import Array
from bayesfric.inference.evidence.importance import LEAST_FOR_A_MEAN, importance_draws
from bayesfric.inference.evidence.record import Evidence
from bayesfric.inference.laplace import NoModeError, laplace_approximation
from bayesfric.inference.pareto import smooth_weights
from bayesfric.inference.proposals import SAMPLING_SPACE, Chart, LogDensity
from bayesfric.inference.sampling_rules import SAMPLING_RULES

SIZE = 2000  # draws of a refit
LEAST_DRAWS = 100  # least posterior draws for leave-one-out weights


@dataclass(frozen=True)
class Refit:
    """A posterior without one of its groups.

    Parameters
    ----------
    draws : ndarray, shape (S, D)
        Draws of this posterior.
    evidence : Evidence
        Evidence of the data without the group, on the scale of the given log density.
    """

    draws: Array
    evidence: Evidence


class Without(NamedTuple):
    """Weights that turn posterior draws into draws of the posterior without a group.

    Parameters
    ----------
    log_weights : ndarray, shape (draws, G)
        Log weights for each omitted group; the weights sum to 1 over the draws.
    pareto_k : ndarray, shape (G,)
        Shape of the tail of each group's weights.
    """

    log_weights: Array
    pareto_k: Array


@dataclass(frozen=True)
class ELPD:
    """Expected log predictive density of G groups, each left out in turn.

    Parameters
    ----------
    pointwise : ndarray, shape (G,)
        log p(y_g | y_−g) of each group [nat].
    pareto_k : ndarray, shape (G,)
        Shape of the tail of each group's weights.
    refitted : ndarray of bool, shape (G,)
        Whether each group has an exact refit.
    limit_k : float
        Largest `pareto_k` that is reliable with this number of draws.
    """

    pointwise: Array
    pareto_k: Array
    refitted: NDArray[np.bool_]
    limit_k: float

    @property
    def total(self) -> float:
        """Sum over the groups [nat]."""
        return float(self.pointwise.sum())

    @property
    def se(self) -> float:
        """Standard error of the total, over new groups of the same kind; inf for a single one."""
        return _standard_error(self.pointwise)

    @property
    def bad(self) -> NDArray[np.bool_]:
        """Whether the weights of each group are unreliable, refitted or not, shape (G,)."""
        return ~(self.pareto_k <= self.limit_k)

    @property
    def reliable(self) -> bool:
        """Whether every group has reliable weights or a refit."""
        return bool((self.refitted | ~self.bad).all())


@dataclass(frozen=True)
class Difference:
    """The difference of two expected log predictive densities.

    Parameters
    ----------
    elpd : float
        First minus second [nat].
    se : float
        Paired standard error; inf for a single group.
    unreliable : tuple of str
        Reasons why the standard error is unreliable; empty if it is reliable.
    """

    elpd: float
    se: float
    unreliable: tuple[str, ...]

    @property
    def reliable(self) -> bool:
        """Whether the standard error is reliable."""
        return not self.unreliable


def without_each(log_likelihood: Array) -> Without:
    """Compute weights of posterior draws for each omitted group.

    Parameters
    ----------
    log_likelihood : ndarray, shape (draws, G)
        log p(y_g | y_−g, θ) of each group for each posterior draw. For groups that are
        independent given θ, this is log p(y_g | θ).

    Raises
    ------
    ValueError
        If there are fewer than 100 draws, or if a density is not finite.
    """
    _check(log_likelihood)
    # Group by group, here and below: further arrays of this shape would double a fit's memory.
    log_weights, pareto_k = np.empty_like(log_likelihood), np.empty(log_likelihood.shape[1])
    for group, column in enumerate(log_likelihood.T):
        smoothed, pareto_k[group] = smooth_weights(-column)
        log_weights[:, group] = smoothed - logsumexp(smoothed)
    return Without(log_weights, pareto_k)


def elpd(
    log_likelihood: Array,
    refit: Callable[[int], float | None] | None = None,
    without: Without | None = None,
) -> ELPD:
    """Estimate leave-one-group-out predictive densities.

    Parameters
    ----------
    log_likelihood : ndarray, shape (draws, G)
        As for :func:`without_each`.
    refit : callable or None
        Of the index of a group, to its exact log p(y_g | y_−g), for example from the draws of
        :func:`refit_without`; or to None if there is none. It is called for groups whose weights
        are unreliable.
    without : Without or None
        Weights of these draws; None computes them.

    Returns
    -------
    ELPD
        Unreliable if a group has neither reliable weights nor a refit.

    Raises
    ------
    ValueError
        If there are fewer than 100 draws, or if a density is not finite.
    """
    log_weights, pareto_k = without or without_each(log_likelihood)
    draws, groups = log_likelihood.shape
    pointwise = np.array(
        [logsumexp(log_weights[:, group] + log_likelihood[:, group]) for group in range(groups)]
    )
    limit_k = min(SAMPLING_RULES.pareto_k, 1 - 1 / np.log10(draws))
    refitted = np.zeros(groups, dtype=bool)
    if refit is not None:
        # NaN counts as unreliable too.
        for bad in np.flatnonzero(~(pareto_k <= limit_k)).tolist():
            exact = refit(bad)
            if exact is not None:
                pointwise[bad], refitted[bad] = exact, True
    return ELPD(pointwise, pareto_k, refitted, float(limit_k))


def difference(first: ELPD, second: ELPD) -> Difference:
    """Compare two models group by group.

    Parameters
    ----------
    first, second : ELPD
        Densities of the same groups in the same order.

    Returns
    -------
    Difference
        Positive if the first model predicts better.

    Raises
    ------
    ValueError
        If the numbers of groups differ.
    """
    if first.pointwise.shape != second.pointwise.shape:
        raise ValueError(
            f"{first.pointwise.size} groups cannot be paired with {second.pointwise.size}"
        )
    pairs = first.pointwise - second.pointwise
    total = float(pairs.sum())
    reasons = []
    if pairs.size < SAMPLING_RULES.difference_least_groups:
        reasons.append(f"{pairs.size} groups, fewer than {SAMPLING_RULES.difference_least_groups}")
    if abs(total) < SAMPLING_RULES.difference_least:
        reasons.append(f"a difference of less than {SAMPLING_RULES.difference_least:g}")
    if not (first.reliable and second.reliable):
        reasons.append("a Pareto k too large without a refit")
    return Difference(total, _standard_error(pairs), tuple(reasons))


def loo_pit(cdf: Array, without: Without) -> Array:
    """Return the leave-one-out probability integral transform (LOO-PIT) of each group.

    It is the leave-one-out predictive probability of a lower value than the observed one. If the
    model is correct, it is uniform between 0 and 1 over the groups.

    Parameters
    ----------
    cdf : ndarray, shape (draws, G)
        P(Y_g ≤ y_g | y_−g, θ) of a scalar of each group, such as Φ of its conditional z-score.
    without : Without
        Weights of these draws.

    Returns
    -------
    ndarray, shape (G,)
        Between 0 and 1.

    Raises
    ------
    ValueError
        If the shapes of `cdf` and the weights differ.

    References
    ----------
    A. Gelfand, D. Dey, H. Chang, "Model determination using predictive distributions
    with implementation via sampling-based methods", Bayesian Statistics 4 (1992).
    """
    log_weights = without.log_weights
    if cdf.shape != log_weights.shape:
        raise ValueError(f"cdf {cdf.shape} and the weights {log_weights.shape} differ")
    below = [
        np.exp(column) @ of_group for column, of_group in zip(log_weights.T, cdf.T, strict=True)
    ]
    # Rounding may put the sum of the weights above 1.
    return np.asarray(np.clip(below, 0.0, 1.0))


def _check(log_likelihood: Array) -> None:
    if log_likelihood.ndim != 2 or len(log_likelihood) < LEAST_DRAWS:
        raise ValueError(
            f"log_likelihood must have the shape (draws, groups) with at least "
            f"{LEAST_DRAWS} draws; the shape is {log_likelihood.shape}"
        )
    if not np.isfinite(log_likelihood).all():
        raise ValueError("log_likelihood must be finite")


def _standard_error(values: Array) -> float:
    if values.size < 2:
        return float("inf")
    return float(np.sqrt(values.size * values.var(ddof=1)))


def refit_without(
    log_density: LogDensity,
    log_conditional: LogDensity,
    start: Array,
    scale: Array,
    seed: int,
    chart: Chart = SAMPLING_SPACE,
) -> Refit | None:
    """Sample a posterior without one of its groups.

    Parameters
    ----------
    log_density : callable
        Unnormalised log posterior of all data, from points of shape (W, D) to shape (W,).
    log_conditional : callable
        log p(y_g | y_−g, θ) of the group, of the same shapes.
    start : ndarray, shape (D,)
        A point of finite density, such as the draw with the highest density.
    scale : ndarray, shape (D,)
        Largest plausible scale of each coordinate, such as that of its prior.
    seed : int
        Seed of the draws.
    chart : Chart
        Coordinates in which a proposal is fitted.

    Returns
    -------
    Refit or None
        None if importance sampling is unreliable.
    """

    def without(points: Array) -> Array:
        density = log_density(points)
        rest = np.full(density.shape, -np.inf)
        possible = np.isfinite(density)
        if possible.any():
            rest[possible] = density[possible] - log_conditional(points[possible])
        return np.where(rest < np.inf, rest, -np.inf)

    try:
        laplace = laplace_approximation(without, start, scale)
    except NoModeError:  # the remaining data may fit exactly, so that the density has no mode
        return None
    drawn = importance_draws(without, laplace, seed, chart, SIZE, least_effective=LEAST_FOR_A_MEAN)
    return None if drawn is None else Refit(drawn[1], drawn[0])

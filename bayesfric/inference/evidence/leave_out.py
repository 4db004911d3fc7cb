"""Leave-one-group-out predictive densities, from draws of the posterior of all data.

The groups of a joint normal are not independent given the parameters θ, so what is
left out is a group g given all others: its density is p(y_g | y_−g, θ). Since

    p(θ | y_−g) ∝ p(θ | y) / p(y_g | y_−g, θ)

holds without any independence, draws of p(θ | y) with the weights 1/p(y_g | y_−g, θ)
are draws of the posterior without g, and the leave-one-out density is the mean over them
of that same conditional density. The weights are Pareto-smoothed; where that
fails, only an exact refit without the group helps.

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

Where the weights of leave-one-out fail, the group decides so much that draws of the
posterior of all data are of no use. The density without it is known all the same,

    p(θ | y_−g) ∝ p(θ | y) / p(y_g | y_−g, θ),

so no model is built again: the mode is climbed to from that of all the data, and the
density is sampled around it by importance.

References
----------
P.-C. Bürkner, J. Gabry, A. Vehtari, "Efficient leave-one-out cross-validation for
Bayesian non-factorized normal and Student-t models", Computational Statistics 36
(2021).
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

SIZE = 2000  # of the draws


LEAST_DRAWS = 100


@dataclass(frozen=True)
class Refit:
    """A posterior without one of its groups.

    Parameters
    ----------
    draws : ndarray, shape (S, D)
        Of it.
    evidence : Evidence
        Of the data without the group, on the scale of the log density that was given.
    """

    draws: Array
    evidence: Evidence


class Without(NamedTuple):
    """Weights that turn posterior draws into draws of the posterior without a group.

    Parameters
    ----------
    log_weights : ndarray, shape (draws, G)
        For each group left out, adding up to 1 over the draws.
    pareto_k : ndarray, shape (G,)
        Shape of the tail of each one's weights.
    """

    log_weights: Array
    pareto_k: Array


@dataclass(frozen=True)
class ELPD:
    """Expected log predictive density of G groups left out one at a time.

    Parameters
    ----------
    pointwise : ndarray, shape (G,)
        log p(y_g | y_−g) of each [nat].
    pareto_k : ndarray, shape (G,)
        Shape of the tail of each one's weights.
    refitted : ndarray of bool, shape (G,)
        Which groups have an exact refit.
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
        """Which groups have weights that fail, refitted or not, shape (G,)."""
        return ~(self.pareto_k <= self.limit_k)

    @property
    def reliable(self) -> bool:
        """Whether every group has been refitted or has weights that can be relied on."""
        return bool((self.refitted | ~self.bad).all())


@dataclass(frozen=True)
class Difference:
    """Of two expected log predictive densities.

    Parameters
    ----------
    elpd : float
        First minus second [nat].
    se : float
        Paired standard error; inf for a single group.
    unreliable : tuple of str
        Why the standard error is not to be relied on; empty if it is.
    """

    elpd: float
    se: float
    unreliable: tuple[str, ...]

    @property
    def reliable(self) -> bool:
        """Whether nothing speaks against the standard error."""
        return not self.unreliable


def without_each(log_likelihood: Array) -> Without:
    """Weigh draws for each group left out.

    Parameters
    ----------
    log_likelihood : ndarray, shape (draws, G)
        log p(y_g | y_−g, θ) of each group for each posterior draw; for groups that are
        independent given θ, the same as log p(y_g | θ).

    Raises
    ------
    ValueError
        Fewer than 100 draws, or densities that are not finite.
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
        Place of a group to its exact log p(y_g | y_−g), such as from the draws of
        :func:`bayesfric.inference.evidence.refit_without`, or to None where that cannot be had;
        called where Pareto smoothing fails.
    without : Without or None
        Weights of these draws; None finds them.

    Returns
    -------
    ELPD
        Unreliable where smoothing fails and there is no refit.

    Raises
    ------
    ValueError
        Fewer than 100 draws, or densities that are not finite.
    """
    log_weights, pareto_k = without or without_each(log_likelihood)
    draws, groups = log_likelihood.shape
    pointwise = np.array(
        [logsumexp(log_weights[:, group] + log_likelihood[:, group]) for group in range(groups)]
    )
    limit_k = min(SAMPLING_RULES.pareto_k, 1 - 1 / np.log10(draws))
    refitted = np.zeros(groups, dtype=bool)
    if refit is not None:
        # A k that is not a number is bad as well.
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
        Of the same groups, in the same order.

    Returns
    -------
    Difference
        Positive if the first predicts better.

    Raises
    ------
    ValueError
        The numbers of groups differ.
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

    It is the probability, had the group been left out, of a lower value than was observed;
    uniform from 0 to 1 over the groups where the model is right.

    Parameters
    ----------
    cdf : ndarray, shape (draws, G)
        P(Y_g ≤ y_g | y_−g, θ) of one number of each group, such as Φ of its
        conditional z-score.
    without : Without
        Weights of these draws.

    Returns
    -------
    ndarray, shape (G,)
        Between 0 and 1.

    Raises
    ------
    ValueError
        Shapes that differ.

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
    # A sum of weights is 1 but for rounding.
    return np.clip(np.array(below), 0.0, 1.0)


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
        Unnormalised log posterior of all data; points of shape (W, D) to shape (W,).
    log_conditional : callable
        log p(y_g | y_−g, θ) of the group, likewise.
    start : ndarray, shape (D,)
        A point of finite density, such as the draw with the highest.
    scale : ndarray, shape (D,)
        Widest plausible scale of each coordinate, such as its prior's.
    seed : int
        Of the draws.
    chart : Chart
        In which a proposal is fitted.

    Returns
    -------
    Refit or None
        None where importance sampling is not to be relied on.
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
    except NoModeError:  # what is left may fit exactly
        return None
    drawn = importance_draws(without, laplace, seed, chart, SIZE, least_effective=LEAST_FOR_A_MEAN)
    return None if drawn is None else Refit(drawn[1], drawn[0])

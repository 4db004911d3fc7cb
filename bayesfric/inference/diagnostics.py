"""Diagnostics of draws and of weights: R-hat, effective sample size, Pareto k, power-scaling.

Walkers of one ensemble depend on one another. R-hat therefore treats all walkers of an ensemble as
one chain, and the effective sample size is the smaller of that of ArviZ and that from batch means
of the ensemble average. A walker has few effective draws, so R-hat with each walker as a chain
exceeds 1 by chance. The walker-wise R-hat detects only walkers that stay apart from the others.

References
----------
A. Vehtari, A. Gelman, D. Simpson, B. Carpenter, P.-C. Bürkner, "Rank-normalization,
folding, and localization: an improved R-hat", Bayesian Analysis 16 (2021).
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import scipy
from numpy.linalg import LinAlgError
from numpy.typing import NDArray
from scipy.linalg import eigh
from scipy.special import logsumexp, ndtri

from bayesfric.arrays import Array
from bayesfric.inference.sampling_rules import SAMPLING_RULES

BATCHES = 10  # batches of the draws of an ensemble
POWERS = 0.99, 1.01  # powers of the prior or the likelihood for a numerical derivative


def _of_arrays() -> Any:
    """Return ArviZ's statistics of arrays, imported on first use because they load slowly."""
    from arviz_stats.base.array import array_stats

    return array_stats


@dataclass(frozen=True)
class Convergence:
    """Diagnostics of one parameter.

    Parameters
    ----------
    r_hat, r_hat_walkers : float
        Rank-normalised R-hat: the split R-hat of ensembles with pooled walkers, and that of single
        walkers by :func:`walkers_r_hat`.
    ess_bulk, ess_tail : float
        Effective draws for the mean and for the 5 and 95 % quantiles.
    mcse_mean : float
        Monte Carlo standard error of the mean.
    """

    r_hat: float
    r_hat_walkers: float
    ess_bulk: float
    ess_tail: float
    mcse_mean: float

    @property
    def converged(self) -> bool:
        """Whether all diagnostics meet the thresholds of :class:`SamplingRules`."""
        return (
            self.r_hat < SAMPLING_RULES.r_hat
            and self.r_hat_walkers < SAMPLING_RULES.r_hat_walkers
            and min(self.ess_bulk, self.ess_tail) >= SAMPLING_RULES.effective_draws
        )


class OfChains(NamedTuple):
    """R-hat and bulk effective draws of chains of one parameter, as in ArviZ's summary."""

    r_hat: float
    ess_bulk: float


def of_chains(chains: Array) -> OfChains:
    """Return R-hat and bulk effective draws of one parameter, as in ArviZ's summary.

    Parameters
    ----------
    chains : ndarray, shape (chains, draws)
        Draws of each chain in their order.
    """
    arviz = _of_arrays()
    return OfChains(float(arviz.rhat(chains)), float(arviz.ess(chains, method="bulk")))


def diagnose_draws(draws: Array) -> Convergence:
    """Return the diagnostics of one parameter.

    Parameters
    ----------
    draws : ndarray, shape (ensembles, draws, walkers)
        Draws in their order.

    Returns
    -------
    Convergence

    Raises
    ------
    ValueError
        If the draws do not vary or are not finite.
    """
    if not np.isfinite(draws).all() or np.ptp(draws) == 0:
        raise ValueError("draws must be finite and must vary")
    ensembles, steps, walkers = draws.shape
    by_walker = draws.transpose(0, 2, 1).reshape(ensembles * walkers, steps)
    pooled = draws.reshape(ensembles, steps * walkers)  # in order of time, so that R-hat can split
    bulk = min(float(_of_arrays().ess(by_walker, method="bulk")), batch_means_ess(draws))
    tail = float(_of_arrays().ess(by_walker, method="tail", prob=(0.05, 0.95)))
    return Convergence(
        r_hat=float(_of_arrays().rhat(pooled)),
        r_hat_walkers=walkers_r_hat(draws),
        ess_bulk=bulk,
        ess_tail=tail,
        mcse_mean=float(draws.std() / np.sqrt(bulk)),
    )


def diagnose_all(theta: Array) -> list[Convergence]:
    """Return the diagnostics of each parameter.

    Parameters
    ----------
    theta : ndarray, shape (ensembles, draws, walkers, D)
        In the order in which they were drawn.
    """
    return [diagnose_draws(theta[..., place]) for place in range(theta.shape[-1])]


def walkers_r_hat(draws: Array) -> float:
    """Return R-hat with each walker as a chain, corrected for the Monte Carlo error of their means.

    The variance between the means of walkers has two parts: differences between the regions in
    which walkers stay, and the Monte Carlo error of the means. The two halves of a walker share
    only its region. So the covariance of their means estimates the variance between regions, even
    if a walker has few effective draws. R-hat squared is the variance of all draws over the
    variance within a region. The result is the larger R-hat of rank-normalised draws and of
    rank-normalised distances from the median.

    Parameters
    ----------
    draws : ndarray, shape (ensembles, draws, walkers)
        In the order in which they were drawn.

    Returns
    -------
    float
        At least 1; inf if no walker leaves its region.
    """
    half = draws.shape[1] // 2
    r_hats = []
    for values in (draws, np.abs(draws - np.median(draws))):
        rank = scipy.stats.rankdata(values.ravel()).reshape(draws.shape)
        normal = ndtri((rank - 3 / 8) / (draws.size + 1 / 4))
        first, second = (part.mean(axis=1).ravel() for part in (normal[:, :half], normal[:, half:]))
        places = max(float(np.cov(first, second)[0, 1]), 0.0)
        whole = float(normal.var())
        r_hats.append(np.sqrt(whole / (whole - places)) if places < whole else np.inf)
    return float(max(r_hats))


def batch_means_ess(draws: Array) -> float:
    """Return the effective sample size by batch means of the ensemble average.

    Parameters
    ----------
    draws : ndarray, shape (ensembles, draws, walkers)
        In the order in which they were drawn.

    Returns
    -------
    float
        Variance of a draw over the variance of the mean of all draws.

    References
    ----------
    C. J. Geyer, "Practical Markov chain Monte Carlo", Statistical Science 7 (1992).
    """
    length = draws.shape[1] // BATCHES
    average = draws[:, : length * BATCHES].mean(axis=2)
    batches = average.reshape(draws.shape[0] * BATCHES, length).mean(axis=1)
    return float(draws.var() / (batches.var(ddof=1) / batches.size))


def rank_counts(draws: Array, bins: int) -> NDArray[np.int_]:
    """Count the draws of each ensemble in ranges of rank among all draws.

    If all ensembles draw from the same density, the counts differ by chance only.

    Parameters
    ----------
    draws : ndarray, shape (ensembles, draws, walkers)
        Draws of one parameter.
    bins : int
        Number of equally wide ranges of rank.

    Returns
    -------
    ndarray of int, shape (ensembles, bins)
        Draws of each ensemble in each range.
    """
    ensembles = draws.shape[0]
    rank = draws.ravel().argsort(kind="stable").argsort(kind="stable")
    place = (rank * bins // draws.size).reshape(ensembles, -1)
    return np.stack([np.bincount(row, minlength=bins) for row in place])


def mean_ess(draws: Array) -> float:
    """Return the number of independent draws whose mean would have the same error.

    Parameters
    ----------
    draws : ndarray, shape (ensembles, draws, walkers)
        In the order in which they were drawn.

    Returns
    -------
    float
        The smaller of ArviZ's estimate and that by batch means; the number of draws if all draws
        are equal.
    """
    if np.ptp(draws) == 0:
        return float(draws.size)
    ensembles, steps, walkers = draws.shape
    by_walker = draws.transpose(0, 2, 1).reshape(ensembles * walkers, steps)
    return min(float(_of_arrays().ess(by_walker, method="mean")), batch_means_ess(draws))


def multivariate_r_hat(chains: Array) -> float:
    """Return the largest split R-hat of any linear combination of the coordinates.

    Modes on parallel narrow ridges overlap in every coordinate, but not in all combinations of
    coordinates.

    Parameters
    ----------
    chains : ndarray, shape (chains, draws, D)
        Draws of each chain in their order.

    Returns
    -------
    float
        Very large or inf if some combination does not vary within the chains.

    References
    ----------
    S. P. Brooks, A. Gelman, "General methods for monitoring convergence of iterative
    simulations", Journal of Computational and Graphical Statistics 7 (1998).
    """
    count, steps, size = chains.shape
    half = steps // 2
    split = chains[:, : 2 * half].reshape(2 * count, half, size)
    # Coordinates are standardised, so that those of small scale are not lost by rounding.
    split = (split - split.mean(axis=(0, 1))) / split.std(axis=(0, 1))
    means = split.mean(axis=1)
    centred = (split - means[:, None]).reshape(-1, size)
    within = centred.T @ centred / (2 * count * (half - 1))
    between = np.atleast_2d(np.cov(means, rowvar=False))
    try:
        largest = eigh(between, within, eigvals_only=True)[-1]
    except LinAlgError:
        return float("inf")
    return float(np.sqrt((half - 1) / half + (1 + 0.5 / count) * largest))


def power_scaling(values: Array, log_component: Array) -> Array:
    """Return the sensitivity of marginals to a power of the prior or of the likelihood.

    Parameters
    ----------
    values : ndarray, shape (chains, draws, K)
        Draws of K coefficients.
    log_component : ndarray, shape (chains, draws)
        Log density of the component that is raised to a power close to 1: the prior of some or
        all parameters, or the likelihood of all data.

    Returns
    -------
    ndarray, shape (K,)
        Change of each marginal per doubling of the power, as a distance between cumulative
        distributions. Above 0.05 the component has a noticeable influence.

    Raises
    ------
    ValueError
        If a value is not finite, or if the component is the same for all draws.

    References
    ----------
    N. Kallioinen, T. Paananen, P.-C. Bürkner, A. Vehtari, "Detecting and diagnosing
    prior and likelihood sensitivity with power-scaling", Statistics and Computing 34
    (2024).
    """
    if not (np.isfinite(values).all() and np.isfinite(log_component).all()):
        raise ValueError("values and log_component must be finite")
    if np.ptp(log_component) == 0:
        raise ValueError("the component is the same for all draws: nothing moves with it")
    low, high = POWERS
    below, above = (np.exp(_power_weights(log_component, power)) for power in POWERS)
    sensitivity = [
        float(_of_arrays().power_scale_sense(values[..., place], below, above, low, high))
        for place in range(values.shape[-1])
    ]
    return np.array(sensitivity)


def _power_weights(log_component: Array, power: float) -> Array:
    """Return smoothed log weights, normalised, for another power of a component.

    If walkers hardly moved, all weights of the tail are equal. ArviZ then raises an error or
    divides by 0, and the weights are not smoothed.
    """
    plain = (power - 1) * log_component
    plain = plain - logsumexp(plain)
    try:
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            smoothed = _of_arrays().power_scale_lw(log_component, alpha=power, axis=(-2, -1))
    except ValueError as error:
        if "tail values are the same" not in str(error):
            raise
        return np.asarray(plain)
    return np.asarray(smoothed if np.isfinite(smoothed).all() else plain)

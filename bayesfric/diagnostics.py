"""Whether draws can be trusted: R-hat, effective sample sizes, Monte Carlo error.

Walkers of one ensemble depend on one another, so R-hat pools them into the chain of
their ensemble, and the effective sample size is the smaller of ArviZ's and that of
batch means of the ensemble average.

References
----------
A. Vehtari, A. Gelman, D. Simpson, B. Carpenter, P.-C. Bürkner, "Rank-normalization,
folding, and localization: an improved R-hat", Bayesian Analysis 16 (2021).
"""

from dataclasses import dataclass

import numpy as np
from arviz_stats.base.array import array_stats
from numpy.typing import NDArray

__all__ = [
    "LIMITS",
    "Convergence",
    "batch_means_ess",
    "diagnose_all",
    "diagnose_draws",
    "rank_counts",
]

Array = NDArray[np.float64]

LIMITS = {"r_hat": 1.01, "r_hat_walkers": 1.02, "ess": 400.0}
"""R-hat below, effective draws above: what counts as converged."""

BATCHES = 10  # of an ensemble


@dataclass(frozen=True)
class Convergence:
    """Diagnostics of one parameter.

    Parameters
    ----------
    r_hat, r_hat_walkers : float
        Rank-normalised split R-hat, walkers pooled by ensemble, and walker-wise.
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
        """Whether every figure is within :data:`LIMITS`."""
        return (
            self.r_hat < LIMITS["r_hat"]
            and self.r_hat_walkers < LIMITS["r_hat_walkers"]
            and min(self.ess_bulk, self.ess_tail) >= LIMITS["ess"]
        )


def diagnose_draws(draws: Array) -> Convergence:
    """Return the diagnostics of one parameter.

    Parameters
    ----------
    draws : ndarray, shape (ensembles, draws, walkers)
        In the order in which they were drawn.

    Returns
    -------
    Convergence
        All figures finite.

    Raises
    ------
    ValueError
        The draws do not vary or are not finite.
    """
    if not np.isfinite(draws).all() or np.ptp(draws) == 0:
        raise ValueError("draws must be finite and must vary")
    ensembles, steps, walkers = draws.shape
    by_walker = draws.transpose(0, 2, 1).reshape(ensembles * walkers, steps)
    pooled = draws.reshape(ensembles, steps * walkers)  # step by step: halves are in time
    bulk = min(float(array_stats.ess(by_walker, method="bulk")), batch_means_ess(draws))
    tail = float(array_stats.ess(by_walker, method="tail", prob=(0.05, 0.95)))
    return Convergence(
        r_hat=float(array_stats.rhat(pooled)),
        r_hat_walkers=float(array_stats.rhat(by_walker)),
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
    """Count where the ranks of each ensemble fall among those of all.

    Ensembles that draw from one density have counts that differ by chance only.

    Parameters
    ----------
    draws : ndarray, shape (ensembles, draws, walkers)
        Of one parameter.
    bins : int
        Ranges of rank, equally wide.

    Returns
    -------
    ndarray of int, shape (ensembles, bins)
        Draws of each ensemble in each range.
    """
    ensembles = draws.shape[0]
    rank = draws.ravel().argsort(kind="stable").argsort(kind="stable")
    place = (rank * bins // draws.size).reshape(ensembles, -1)
    return np.stack([np.bincount(row, minlength=bins) for row in place])

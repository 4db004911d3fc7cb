"""The log evidence from draws, by bridge sampling.

Let p be the unnormalised density, of which there are n₁ draws, and g a normalised proposal, of
which n₂ points are drawn. With l = log p − log g, the estimate of the optimal bridge of Meng and
Wong is the fixed point λ = log Z of their iteration. It is the only root of

    n₂ ⟨σ(l − λ + c)⟩_g − n₁ ⟨σ(λ − l − c)⟩_p ,    c = log(n₁/n₂),

where σ is the logistic function. This expression decreases with λ, so its root is found by
bracketing, which always converges. A proposal that is fitted to the same draws would bias the
estimate. So the proposal for each half of the draws is fitted to the other half, and the two
estimates are averaged.

References
----------
X.-L. Meng, W. H. Wong, "Simulating ratios of normalizing constants via a simple
identity: a theoretical exploration", Statistica Sinica 6 (1996).
Q. F. Gronau et al., "A tutorial on bridge sampling", Journal of Mathematical
Psychology 81 (2017).
S. Frühwirth-Schnatter, "Estimating marginal likelihoods for mixture and Markov
switching models using bridge sampling techniques", Econometrics Journal 7 (2004).
"""

import numpy as np
import scipy
from numpy.typing import NDArray
from scipy.special import expit

from bayesfric.arrays import Array
from bayesfric.inference.diagnostics import mean_ess, multivariate_r_hat
from bayesfric.inference.evidence.record import Evidence, SeparatedModes
from bayesfric.inference.proposals import LogDensity, StudentT
from bayesfric.inference.sampling_rules import SAMPLING_RULES

DRAWS_A_HALF = 2000  # draws of each half at which the density is evaluated; as many proposals
STEPS_A_HALF = (20, 10)  # steps of each half: 20 if there are so many (multiples of the batches)


def bridge_evidence(
    log_density: LogDensity, draws: Array, seed: int | np.random.Generator
) -> Evidence:
    """Estimate the log evidence from converged draws.

    A mode that no walker has visited is missing in the estimate.

    Parameters
    ----------
    log_density : callable
        Unnormalised log density, from points of shape (W, D) to shape (W,).
    draws : ndarray, shape (ensembles, kept, walkers, D)
        Draws of that density in their order, with at least 20 kept steps. The proposals are
        fitted to all of them; the density is evaluated at about 4000.
    seed : int or Generator
        Seed of the proposals.

    Returns
    -------
    Evidence
        Its error allows for the autocorrelation of the draws.

    Raises
    ------
    SeparatedModes
        If ensembles or walkers sample different modes, or if the draws and a Student-t
        distribution fitted to them do not overlap.
    ValueError
        If draws have another shape or are not finite, or if the density at a draw is zero or NaN.
    """
    if draws.ndim != 4 or draws.shape[1] < 2 * STEPS_A_HALF[-1] or not np.isfinite(draws).all():
        raise ValueError(
            "draws must be finite, of shape (ensembles, kept, walkers, D) "
            f"with at least {2 * STEPS_A_HALF[-1]} kept; the shape is {draws.shape}"
        )
    _refuse_separated(draws)
    rng = np.random.default_rng(seed)
    middle = draws.shape[1] // 2
    first, second = draws[:, :middle], draws[:, middle:]
    value1, error1 = _bridge(log_density, first, second, rng)
    value2, error2 = _bridge(log_density, second, first, rng)
    error = float(np.hypot(error1, error2)) / 2
    return Evidence((value1 + value2) / 2, error, "bridge sampling")


def bridge_ratio(at_first: Array, at_second: Array) -> tuple[float, float]:
    """Estimate the ratio of the integrals of two densities, from independent draws of both.

    Parameters
    ----------
    at_first, at_second : ndarray, shape (N₁,) and (N₂,)
        Log of the ratio of the first to the second unnormalised density, at draws of the first
        and of the second; −inf where the first density is zero.

    Returns
    -------
    log_ratio, error : float
        Log of the ratio of the first to the second integral, and its standard error [nat]. The
        error is large if the two densities hardly overlap, and infinite if they do not.

    References
    ----------
    C. H. Bennett, "Efficient estimation of free energy differences from Monte Carlo
    data", Journal of Computational Physics 22 (1976).
    """
    log_ratio, of_first, of_second = _stand(at_first, at_second, float(at_first.size))
    parts = (of_first, of_second)
    if not (of_first.any() and of_second.any()):  # no draw of one density is inside the other
        return log_ratio, np.inf
    variance = sum(part.var() / part.mean() ** 2 / part.size for part in parts)
    return log_ratio, float(np.sqrt(variance))


def _bridge(
    log_density: LogDensity, fitted: Array, used: Array, rng: np.random.Generator
) -> tuple[float, float]:
    """Return the log evidence and its error from the draws `used`.

    The proposal is fitted to the draws `fitted`.
    """
    size = used.shape[-1]
    proposal = StudentT.around(fitted.reshape(-1, size))
    used = _thinned(used)
    points = used.reshape(-1, size)
    at_points = _evaluated(log_density, points)
    if not np.isfinite(at_points).all():
        raise ValueError("the density is zero at a draw: the draws are of another density")
    at_draws = (at_points - proposal.log_density(points)).reshape(used.shape[:-1])
    proposed = proposal.draw(DRAWS_A_HALF, rng)
    at_proposed = _evaluated(log_density, proposed) - proposal.log_density(proposed)

    # The effective number of draws depends on the bridge functions, so the bridge is solved twice.
    counted = float(at_draws.size)
    for _ in range(2):
        log_evidence, of_draws, of_proposed = _stand(at_draws, at_proposed, counted)
        counted = mean_ess(of_draws)
    overlap = of_draws.mean() * (1 + counted / DRAWS_A_HALF)
    if overlap < SAMPLING_RULES.bridge_least_overlap:
        raise SeparatedModes(
            f"the draws and a Student-t fitted to them overlap by {overlap:.1%}, "
            f"less than {SAMPLING_RULES.bridge_least_overlap:.0%}: no single place holds them"
        )
    variance = (
        of_draws.var() / of_draws.mean() ** 2 / counted
        + of_proposed.var() / of_proposed.mean() ** 2 / DRAWS_A_HALF
    )
    return log_evidence, float(np.sqrt(variance))


def _evaluated(log_density: LogDensity, points: Array) -> Array:
    """Return log densities, shape (N,); raise an error if one is NaN or +inf."""
    values = log_density(points)
    if not (values < np.inf).all():
        raise ValueError("a log density is NaN or +inf")
    return values


def _stand(at_draws: Array, at_proposed: Array, counted: float) -> tuple[float, Array, Array]:
    """Return λ, and the logistic terms at the draws and at the proposals.

    `counted` is the effective number of draws, n₁.
    """
    shift = np.log(counted / at_proposed.size)

    def of_draws(value: float) -> Array:
        return np.asarray(expit(value - at_draws - shift))

    def of_proposed(value: float) -> Array:
        return np.asarray(expit(at_proposed - value + shift))

    def balance(value: float) -> float:
        left, right = of_proposed(value).mean(), of_draws(value).mean()
        return float(at_proposed.size * left - counted * right)

    # 40 nat beyond all values, each logistic function is 0 or 1 up to rounding.
    both = np.concatenate([at_draws.ravel(), at_proposed[np.isfinite(at_proposed)]])
    root = float(
        scipy.optimize.brentq(balance, both.min() - 40 - abs(shift), both.max() + 40 + abs(shift))
    )
    return root, of_draws(root), of_proposed(root)


def _thinned(draws: Array) -> Array:
    """Return the draws at evenly spaced steps and walkers."""
    ensembles, kept, walkers, _ = draws.shape
    steps = next(count for count in STEPS_A_HALF if count <= kept)
    share = min(walkers, max(1, DRAWS_A_HALF // (ensembles * steps)))
    return draws[:, _spread(steps, kept)][:, :, _spread(share, walkers)]


def _spread(count: int, available: int) -> NDArray[np.int_]:
    return (np.arange(count) * available) // count


def in_one_place(draws: Array) -> bool:
    """Return whether ensembles and walkers sample the same mode, as bridge sampling requires.

    Parameters
    ----------
    draws : ndarray, shape (ensembles, kept, walkers, D)
        Draws in their order.
    """
    pooled, single = _spread_of_places(draws)
    return (
        pooled <= SAMPLING_RULES.bridge_r_hat_ensembles
        and single <= SAMPLING_RULES.bridge_r_hat_walkers
    )


def _spread_of_places(draws: Array) -> tuple[float, float]:
    """Return the multivariate R-hat between ensembles and between walkers."""
    ensembles, kept, walkers, size = draws.shape
    by_walker = draws.transpose(0, 2, 1, 3).reshape(ensembles * walkers, kept, size)
    pooled = multivariate_r_hat(draws.reshape(ensembles, kept * walkers, size))
    return pooled, multivariate_r_hat(by_walker)


def _refuse_separated(draws: Array) -> None:
    pooled, single = _spread_of_places(draws)
    if (
        pooled > SAMPLING_RULES.bridge_r_hat_ensembles
        or single > SAMPLING_RULES.bridge_r_hat_walkers
    ):
        raise SeparatedModes(
            "the chains have not converged to one distribution: multivariate R-hat "
            f"{pooled:.3g} between ensembles (at most {SAMPLING_RULES.bridge_r_hat_ensembles}), "
            f"{single:.3g} between walkers (at most {SAMPLING_RULES.bridge_r_hat_walkers})"
        )

"""The log evidence from draws, by bridge sampling.

The bridge stands between the density p, of which there are n₁ draws, and a normalised
proposal g, of which n₂ are drawn. With l = log p − log g, still unnormalised, the
optimal bridge of Meng and Wong is the fixed point λ = log Z of their iteration, which
is also the only root of

    n₂ ⟨σ(l − λ + c)⟩_g − n₁ ⟨σ(λ − l − c)⟩_p ,    c = log(n₁/n₂),

with σ the logistic function. The left side falls in λ, so the root is bracketed
instead of iterated: nothing can fail to converge. Each half of the draws fits the
proposal for the other half, since draws that have fitted their own proposal bias the
bridge, and the two estimates are averaged.

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

DRAWS_A_HALF = 2000  # at which the density is evaluated, and as many proposals
STEPS_A_HALF = (20, 10)  # the first that there are; multiples of the batches of an error


def bridge_evidence(
    log_density: LogDensity, draws: Array, seed: int | np.random.Generator
) -> Evidence:
    """Estimate the log evidence from converged draws.

    A mode that no walker has found cannot be noticed.

    Parameters
    ----------
    log_density : callable
        Unnormalised; points of shape (W, D) to log densities of shape (W,).
    draws : ndarray, shape (ensembles, kept, walkers, D)
        Of that density, in the order in which they were drawn; at least 20 kept.
        All of them fit the proposals; some 4000 are evaluated.
    seed : int or Generator
        Of the proposals.

    Returns
    -------
    Evidence
        Its error takes in that draws depend on one another.

    Raises
    ------
    SeparatedModes
        Ensembles or walkers sample different modes, or no Student-t overlaps with the
        draws.
    ValueError
        Draws of another shape, not finite, or where the density is zero or no number.
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
        Log of the first density over the second, unnormalised, at draws of the first and
        of the second; −inf where the first is zero.

    Returns
    -------
    log_ratio, error : float
        Log of the first integral over the second, and its standard error [nat]; the error
        is large where the two hardly overlap.

    References
    ----------
    C. H. Bennett, "Efficient estimation of free energy differences from Monte Carlo
    data", Journal of Computational Physics 22 (1976).
    """
    log_ratio, of_first, of_second = _stand(at_first, at_second, float(at_first.size))
    parts = (of_first, of_second)
    variance = sum(part.var() / part.mean() ** 2 / part.size for part in parts)
    return log_ratio, float(np.sqrt(variance))


def _bridge(
    log_density: LogDensity, fitted: Array, used: Array, rng: np.random.Generator
) -> tuple[float, float]:
    """Return the log evidence and its error, of the `used` draws."""
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

    # The effective number of dependent draws follows from the bridge, so it is solved twice.
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
    """Return log densities, finite or −inf where the density is zero, shape (N,)."""
    values = log_density(points)
    if not (values < np.inf).all():
        raise ValueError("a log density is NaN or +inf")
    return values


def _stand(at_draws: Array, at_proposed: Array, counted: float) -> tuple[float, Array, Array]:
    """Return λ and both bridge functions, one for each draw and proposal."""
    shift = np.log(counted / at_proposed.size)

    def of_draws(value: float) -> Array:
        return np.asarray(expit(value - at_draws - shift))

    def of_proposed(value: float) -> Array:
        return np.asarray(expit(at_proposed - value + shift))

    def balance(value: float) -> float:
        left, right = of_proposed(value).mean(), of_draws(value).mean()
        return float(at_proposed.size * left - counted * right)

    # 40 nat beyond all of them every logistic is 0 or 1 to rounding.
    both = np.concatenate([at_draws.ravel(), at_proposed[np.isfinite(at_proposed)]])
    root = float(
        scipy.optimize.brentq(balance, both.min() - 40 - abs(shift), both.max() + 40 + abs(shift))
    )
    return root, of_draws(root), of_proposed(root)


def _thinned(draws: Array) -> Array:
    """Return evenly spaced steps and walkers of all."""
    ensembles, kept, walkers, _ = draws.shape
    steps = next(count for count in STEPS_A_HALF if count <= kept)
    share = min(walkers, max(1, DRAWS_A_HALF // (ensembles * steps)))
    return draws[:, _spread(steps, kept)][:, :, _spread(share, walkers)]


def _spread(count: int, available: int) -> NDArray[np.int_]:
    return (np.arange(count) * available) // count


def in_one_place(draws: Array) -> bool:
    """Return whether ensembles and walkers sample one mode, as :func:`bridge_evidence` needs.

    Parameters
    ----------
    draws : ndarray, shape (ensembles, kept, walkers, D)
        In the order in which they were drawn.
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

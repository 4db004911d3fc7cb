"""Evidences of densities and of fits: Laplace, importance, bridge; what leaving out predicts.

The curved density below is no posterior of friction: the estimators know none. Samples of a fixed
seed are continuous in the density that they are drawn around, so that most of these numbers are
held as integrals are.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
from fingerprint import access
from fingerprint.numbers import Number, closed, drawn, integrated
from fingerprint.points import points_of

from bayesfric.analysis import HalfNormal, Normal
from bayesfric.inference import diagnostics, pareto, power
from bayesfric.inference.evidence import bridge, importance, leave_out
from bayesfric.inference.laplace import laplace_approximation
from bayesfric.inference.proposals import StudentT

SIZES = np.array([0.5, 1.2, 0.8])


def numbers() -> dict[str, Number]:
    """Return evidences, their errors and weights."""
    return dict((*_of_a_curved_density(), *_of_groups(), *_of_draws(), *_of_rigs(), *_of_power()))


def curved(points: np.ndarray) -> np.ndarray:
    """Return a log density whose ridge is bent and whose tails are heavy, (W,)."""
    x, y, z = (points / SIZES).T
    along = -0.5 * x**2 - 2.5 * np.log1p(((y - 0.3 * x**2) ** 2) / 4)
    return along - 0.5 * (z - 0.4 * x) ** 2 / 0.7 - 0.05 * z**4 + 1.7


def draws(count: int) -> np.ndarray:
    """Return independent draws of that density by rejection, (count, 3)."""
    rng = np.random.default_rng(471)
    wide = StudentT(np.array([0.0, 0.5, 0.0]), np.diag((2.2 * SIZES) ** 2), 4.0)
    tried = wide.draw(200 * count, rng)
    ratio = curved(tried) - wide.log_density(tried)
    return tried[np.log(rng.uniform(size=ratio.size)) < ratio - ratio.max()][:count]


def _of_a_curved_density() -> Iterator[tuple[str, Number]]:
    laplace = laplace_approximation(curved, np.array([0.4, 0.9, -0.5]), np.ones(3))
    yield "curved: mode's log density", integrated(laplace.log_density)
    yield "curved: Laplace", integrated(_laplace(laplace))
    yield "curved: log determinant", integrated(np.linalg.slogdet(laplace.covariance)[1])
    weighed = importance.importance_draws(curved, laplace, 472, size=1000)
    assert weighed is not None
    yield "curved: importance", integrated(weighed[0].log_evidence)
    yield "curved: importance, error", drawn(weighed[0].error, 0.02 * weighed[0].error)
    sample = draws(1200).reshape(4, 30, 10, 3)
    by_bridge = bridge.bridge_evidence(curved, sample, 473)
    yield "curved: bridge", integrated(by_bridge.log_evidence)
    yield "curved: bridge, error", drawn(by_bridge.error, 0.02 * by_bridge.error)
    first, second = sample.reshape(-1, 3), draws(1200) * 1.1 + 0.05

    def ratio(points: np.ndarray) -> np.ndarray:
        return curved(points) - curved((points - 0.05) / 1.1)

    value, error = bridge.bridge_ratio(ratio(first), ratio(second))
    yield "curved: ratio by a bridge", integrated(value)
    yield "curved: ratio by a bridge, error", integrated(error)
    points = first[::150]
    heavy = StudentT.around(first)
    yield "Student-t around draws: log density", closed(heavy.log_density(points))
    yield "Student-t around draws, wider", closed(heavy.wider(1.5).log_density(points))


def _of_groups() -> Iterator[tuple[str, Number]]:
    rng = np.random.default_rng(474)
    log_likelihood = rng.standard_normal((400, 6)) * np.array([0.1, 0.3, 0.5, 0.8, 1.0, 0.2]) - 3
    elpd = leave_out.elpd(log_likelihood)
    yield "left out: log densities", closed(elpd.pointwise)
    yield "left out: Pareto k", integrated(elpd.pareto_k)
    without = leave_out.without_each(log_likelihood)
    probabilities = rng.uniform(size=(400, 6))
    yield "left out: probabilities", closed(leave_out.loo_pit(probabilities, without))
    other = leave_out.elpd(log_likelihood + 0.1 * rng.standard_normal((400, 6)) + 0.05)
    apart = leave_out.difference(elpd, other)
    yield "left out: difference", closed([apart.elpd, apart.se])


def _of_draws() -> Iterator[tuple[str, Number]]:
    rng = np.random.default_rng(475)
    chain = rng.standard_normal((4, 40, 10)).cumsum(axis=1) * 0.15 + rng.standard_normal(
        (4, 40, 10)
    )
    convergence = diagnostics.diagnose_draws(chain)
    for name in ("r_hat", "r_hat_walkers", "ess_bulk", "ess_tail", "mcse_mean"):
        yield f"draws: {name}", closed(getattr(convergence, name))
    yield "draws: batch means", closed(diagnostics.batch_means_ess(chain))
    yield (
        "draws: R-hat of several",
        closed(diagnostics.multivariate_r_hat(draws(400).reshape(4, 100, 3))),
    )
    weights, k = pareto.smooth_weights(2 * rng.standard_normal(500))
    yield "weights: Pareto k", integrated(k)
    yield "weights: largest", integrated(np.sort(weights)[-20:])


def _of_rigs() -> Iterator[tuple[str, Number]]:
    for rig in ("motor", "points"):
        model = access.model(rig)
        laplace = access.laplace(model)
        yield f"{rig}: mode's log density", integrated(laplace.log_density)
        yield f"{rig}: Laplace", integrated(_laplace(laplace))
        weighed = access.importance(model, 476)
        yield f"{rig}: importance", drawn(weighed.log_evidence, weighed.error)
        point = points_of(rig)["bulk"]
        yield f"{rig}: log posterior as sampled", closed(access.log_posterior(model, point))
        yield f"{rig}: slope of coordinates", closed(access.coordinates_slope(model, point))


def _of_power() -> Iterator[tuple[str, Number]]:
    for prior in (Normal(mean=0.0, sd=0.3), HalfNormal(scale=0.2)):
        name = f"power, {prior.family}"
        factors = [power.log_bayes_factor(estimate, 0.04, prior) for estimate in (0.0, 0.05, 0.2)]
        yield f"{name}: Bayes factors", closed(factors)
        yield f"{name}: smallest found", integrated(power.smallest_found(0.04, prior, 2.3, 0.9))


def _laplace(normal: Any) -> float:
    """Return the log evidence of a normal approximation."""
    size = normal.mode.size
    determinant = np.linalg.slogdet(normal.covariance)[1]
    return float(normal.log_density + 0.5 * (size * np.log(2 * np.pi) + determinant))

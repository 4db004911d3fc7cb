"""Diagnostics of draws whose effective number is known."""

import arviz_base
import arviz_stats
import numpy as np
import pytest
from arviz_stats.base.array import array_stats

from bayesfric.inference.diagnostics import (
    batch_means_ess,
    diagnose_draws,
    mean_ess,
    multivariate_r_hat,
    power_scaling,
    rank_counts,
    walkers_r_hat,
)
from bayesfric.inference.pareto import smooth_weights
from bayesfric.inference.sampling_rules import SAMPLING_RULES


def autoregressive(rho, shape, seed, shared=0.0):
    """AR(1) walkers, unit variance; `shared` is the part common to an ensemble."""
    rng = np.random.default_rng(seed)
    ensembles, steps, walkers = shape
    draws = np.empty(shape)

    def innovation():
        own = rng.standard_normal((ensembles, walkers))
        return np.sqrt(1 - shared) * own + np.sqrt(shared) * rng.standard_normal((ensembles, 1))

    draws[:, 0] = innovation()
    for step in range(1, steps):
        draws[:, step] = rho * draws[:, step - 1] + np.sqrt(1 - rho**2) * innovation()
    return draws


def test_independent_draws_count_in_full():
    figures = diagnose_draws(autoregressive(0.0, (4, 500, 20), 1))
    assert figures.converged
    assert figures.ess_bulk == pytest.approx(40_000, rel=0.5)  # batch means: 40 batches
    assert figures.r_hat < 1.001
    assert figures.mcse_mean == pytest.approx(1 / np.sqrt(figures.ess_bulk), rel=0.02)


def test_autocorrelated_draws_count_less():
    # The ESS of an AR(1) is N (1 − ρ)/(1 + ρ): a ninth at ρ = 0.8.
    ess = [batch_means_ess(autoregressive(0.8, (4, 2000, 20), s)) for s in range(10)]
    assert np.mean(ess) == pytest.approx(4 * 2000 * 20 / 9, rel=0.25)


def test_walkers_that_move_together_are_not_independent():
    """ArviZ alone would count 20 walkers; their common part is one chain."""
    draws = autoregressive(0.0, (4, 1000, 20), 3, shared=0.5)
    figures = diagnose_draws(draws)
    # Variance of the mean: (0.5 + 0.5/20)/4000 of unit variance.
    assert figures.ess_bulk == pytest.approx(4000 / 0.525, rel=0.5)
    assert figures.ess_bulk < 20_000


def test_ensembles_in_different_places_have_not_converged():
    draws = autoregressive(0.0, (4, 500, 20), 4)
    draws[0] += 0.5
    figures = diagnose_draws(draws)
    assert figures.r_hat > SAMPLING_RULES.r_hat
    assert not figures.converged


def test_a_stuck_walker_shows_walker_wise():
    draws = autoregressive(0.0, (4, 500, 20), 5)
    draws[2, :, 7] = 2.5 + 1e-3 * draws[2, :, 7]
    figures = diagnose_draws(draws)
    assert figures.r_hat_walkers > SAMPLING_RULES.r_hat_walkers
    assert not figures.converged


@pytest.mark.parametrize("rho", [0.0, 0.8])
def test_walkers_r_hat_is_of_their_places_alone(rho):
    """A place of variance v has R-hat √(1 + v), though a half has 40 draws or 4 effective ones."""
    r_hats, apart = [], []
    for seed in range(10):
        draws = autoregressive(rho, (4, 80, 40), 20 + seed)
        place = np.random.default_rng(seed).standard_normal((4, 1, 40))
        r_hats.append(walkers_r_hat(draws))
        apart.append(walkers_r_hat(draws + np.sqrt(0.3) * place))
    # Halves meet: their means share ρ/(1 − ρ)² / 40² of a variance, 0.0125 at ρ = 0.8.
    assert np.mean(r_hats) == pytest.approx(1 + 0.5 * rho / (1 - rho) ** 2 / 1600, abs=0.004)
    assert np.mean(apart) == pytest.approx(np.sqrt(1.3), abs=0.03)


def test_walkers_of_different_widths_show():
    draws = autoregressive(0.0, (4, 200, 20), 30)
    draws[:, :, ::2] *= 2
    assert walkers_r_hat(draws) > SAMPLING_RULES.r_hat_walkers


def test_walkers_that_do_not_leave_their_places():
    places = np.random.default_rng(31).standard_normal((4, 1, 20))
    assert walkers_r_hat(np.repeat(places, 60, axis=1)) == float("inf")


def test_a_drift_in_time_shows_in_the_pooled_split():
    draws = autoregressive(0.0, (4, 500, 20), 6)
    draws += np.linspace(-0.5, 0.5, 500)[None, :, None]
    assert diagnose_draws(draws).r_hat > SAMPLING_RULES.r_hat


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_draws_that_are_not_finite_are_refused(bad):
    draws = autoregressive(0.0, (4, 50, 10), 7)
    draws[0, 0, 0] = bad
    with pytest.raises(ValueError, match="finite"):
        diagnose_draws(draws)


def test_draws_that_do_not_vary_are_refused():
    with pytest.raises(ValueError, match="vary"):
        diagnose_draws(np.ones((4, 50, 10)))


def test_mean_ess_of_dependent_and_of_equal_draws():
    draws = autoregressive(0.8, (4, 2000, 20), 8)
    assert mean_ess(draws) == pytest.approx(4 * 2000 * 20 / 9, rel=0.5)
    assert mean_ess(np.ones((4, 50, 10))) == 2000
    together = autoregressive(0.0, (4, 1000, 20), 9, shared=0.5)
    assert mean_ess(together) == pytest.approx(4000 / 0.525, rel=0.5)


def test_multivariate_r_hat_sees_what_no_coordinate_shows():
    rng = np.random.default_rng(10)
    along, across = 10 * rng.standard_normal((4, 500)), 0.1 * rng.standard_normal((4, 500))
    together = multivariate_r_hat(np.stack([along + across, along - across], axis=-1))
    across += np.array([0.5, -0.5, 0.5, -0.5])[:, None]
    apart = np.stack([along + across, along - across], axis=-1)
    assert together < 1.02
    assert max(multivariate_r_hat(apart[..., i : i + 1]) for i in (0, 1)) < 1.02
    assert multivariate_r_hat(apart) > 3


def test_multivariate_r_hat_does_not_depend_on_units():
    chains = np.random.default_rng(11).standard_normal((4, 100, 3))
    mixed = 5.0 + chains @ np.array([[1.0, 0.9, 0.0], [0.0, 1e-6, 0.0], [0.0, 0.0, 1e6]])
    assert multivariate_r_hat(mixed) == pytest.approx(multivariate_r_hat(chains), rel=1e-6)


def test_multivariate_r_hat_splits_chains():
    drift = np.random.default_rng(12).standard_normal((4, 200, 2))
    drift[:, 100:] += 3.0
    assert multivariate_r_hat(drift) > 1.5


def test_chains_that_stand_still_have_a_huge_r_hat():
    still = np.broadcast_to(np.arange(4.0)[:, None, None], (4, 50, 1))
    assert multivariate_r_hat(still) > 1e6


@pytest.mark.parametrize("shape", [0.2, 0.5, 0.9])
def test_pareto_shape_of_pareto_weights(shape):
    """Weights u^(−k) of a uniform u are Pareto with shape k."""
    log_weights = -shape * np.log(np.random.default_rng(13).uniform(size=20_000))
    smoothed, k = smooth_weights(log_weights + 1000.0)
    assert k == pytest.approx(shape, abs=0.15)
    # Only the tail is touched, and the scale is kept.
    order = np.argsort(log_weights)
    assert smoothed[order[:19_000]] == pytest.approx(log_weights[order[:19_000]] + 1000.0)
    assert np.logaddexp.reduce(smoothed) == pytest.approx(
        np.logaddexp.reduce(log_weights + 1000.0), abs=0.1 if shape < 0.9 else 1.0
    )


@pytest.mark.parametrize("count", [40, 224, 3000])
@pytest.mark.parametrize("shape", [-0.3, 0.4, 1.2])
def test_weights_are_smoothed_as_arviz_smooths_them(count, shape):
    log_weights = -shape * np.log(np.random.default_rng(count).uniform(size=count)) - 900.0
    smoothed, k = smooth_weights(log_weights)
    theirs, their_k = array_stats.psislw(-log_weights, r_eff=1.0)
    assert k == pytest.approx(float(their_k), rel=1e-9)
    assert np.diff(smoothed - theirs) == pytest.approx(0.0, abs=1e-9)  # but for their scale


def test_weights_of_zero_and_equal_weights():
    log_weights = np.concatenate([np.full(500, -np.inf), np.linspace(0, 1, 1500)])
    smoothed, k = smooth_weights(log_weights)
    assert (smoothed[:500] == -np.inf).all()
    assert np.isfinite(k)
    few = np.concatenate([np.full(500, -np.inf), np.linspace(0, 1, 24)])
    assert smooth_weights(few)[1] == float("inf")
    apart = -100.0 * np.arange(64)  # all but the seven largest are below the smallest number
    smoothed, k = smooth_weights(apart)
    assert k == float("inf")
    assert (smoothed == apart).all()
    same, k = smooth_weights(np.zeros(400))
    assert (same == 0).all()
    assert k == 0


@pytest.mark.parametrize("span", [640.0, 690.0, 700.0, 705.0])
def test_weights_that_span_the_range_of_doubles_are_not_relied_on(span):
    """One draw has all the weight: whatever overflows on the way, k says so."""
    low, tail = np.linspace(-span - 10, -span - 9, 980), np.linspace(-span, 50 - span, 19)
    smoothed, k = smooth_weights(np.concatenate([low, tail, [0.0]]))
    assert k > 0.7
    assert np.argmax(smoothed) == 999
    assert np.isfinite(smoothed).all()


def test_power_scaling_tells_data_from_prior():
    """A coefficient that the data tell about, and one that only its prior does."""
    rng = np.random.default_rng(14)
    measured = rng.normal(0.5, 0.1, (4, 2000))  # prior N(0, 10), measured with N(0, 0.1)
    guessed = rng.normal(0.0, 1.0, (4, 2000))  # prior N(0, 1), not measured
    values = np.stack([measured, guessed], axis=-1)
    prior = -0.5 * ((measured / 10) ** 2 + guessed**2)
    likelihood = -0.5 * ((measured - 0.5) / 0.1) ** 2
    of_prior, of_likelihood = power_scaling(values, prior), power_scaling(values, likelihood)
    assert of_prior[1] > 0.05 > of_prior[0]
    assert of_likelihood[0] > 0.05 > of_likelihood[1]


def test_power_scaling_is_arvizs():
    rng = np.random.default_rng(15)
    values, prior = rng.standard_normal((4, 500, 1)), rng.standard_normal((4, 500))
    tree = arviz_base.from_dict({"posterior": {"b": values[..., 0]}, "log_prior": {"b": prior}})
    expected = arviz_stats.psense(tree, group="prior")["b"].item()
    assert power_scaling(values, prior)[0] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(("component", "match"), [(np.nan, "finite"), (1.0, "same for all")])
def test_power_scaling_of_nothing_is_refused(component, match):
    with pytest.raises(ValueError, match=match):
        power_scaling(np.zeros((4, 50, 1)), np.full((4, 50), component))


def test_ranks_are_counted_in_bins():
    draws = np.array([[[5.0, 1.0], [2.0, 3.0]], [[4.0, 6.0], [8.0, 7.0]]])  # ranks in fours
    assert rank_counts(draws, 4).tolist() == [[2, 1, 1, 0], [0, 1, 1, 2]]


def test_the_sign_of_a_parameter_does_not_matter_to_walkers():
    draws = autoregressive(0.5, (2, 60, 5), 32) + np.linspace(0, 2, 5)
    assert walkers_r_hat(-draws) == pytest.approx(walkers_r_hat(draws), rel=1e-12)


def test_of_one_coordinate_the_multivariate_r_hat_is_in_closed_form():
    """(n − 1) / n + (1 + 1/m) B / W, with m halves of n draws each."""
    chains = np.random.default_rng(33).standard_normal((3, 10, 1))
    chains += np.array([0.0, 1.0, 3.0])[:, None, None]
    halves = chains.reshape(6, 5)
    ratio = halves.mean(axis=1).var(ddof=1) / halves.var(axis=1, ddof=1).mean()
    expected = np.sqrt(4 / 5 + (1 + 1 / 6) * ratio)
    assert multivariate_r_hat(chains) == pytest.approx(expected, rel=1e-12)


def test_largest_weights_that_are_equal_have_no_tail():
    smoothed, k = smooth_weights(np.concatenate([np.linspace(-5, -1, 395), np.zeros(5)]))
    assert k == 0
    assert (smoothed[-5:] == 0).all()


def test_power_scaling_of_walkers_that_hardly_moved():
    """Almost all draws are one: to their tail no Pareto distribution can be fitted."""
    values = np.zeros((4, 200, 1))
    values[0, :3, 0] = 1.0
    component = np.zeros((4, 200))
    component[0, :3] = [1.0, 2.0, 3.0]
    assert np.isfinite(power_scaling(values, component)).all()

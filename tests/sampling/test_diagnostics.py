"""Diagnostics of draws whose effective number is known."""

import numpy as np
import pytest

from bayesfric.diagnostics import LIMITS, batch_means_ess, diagnose_draws


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
    found = [batch_means_ess(autoregressive(0.8, (4, 2000, 20), s)) for s in range(10)]
    assert np.mean(found) == pytest.approx(4 * 2000 * 20 / 9, rel=0.25)


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
    assert figures.r_hat > LIMITS["r_hat"]
    assert not figures.converged


def test_a_stuck_walker_shows_walker_wise():
    draws = autoregressive(0.0, (4, 500, 20), 5)
    draws[2, :, 7] = 2.5 + 1e-3 * draws[2, :, 7]
    figures = diagnose_draws(draws)
    assert figures.r_hat_walkers > LIMITS["r_hat_walkers"]
    assert not figures.converged


def test_a_drift_in_time_shows_in_the_pooled_split():
    draws = autoregressive(0.0, (4, 500, 20), 6)
    draws += np.linspace(-0.5, 0.5, 500)[None, :, None]
    assert diagnose_draws(draws).r_hat > LIMITS["r_hat"]


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_draws_that_are_not_finite_are_refused(bad):
    draws = autoregressive(0.0, (4, 50, 10), 7)
    draws[0, 0, 0] = bad
    with pytest.raises(ValueError, match="finite"):
        diagnose_draws(draws)


def test_draws_that_do_not_vary_are_refused():
    with pytest.raises(ValueError, match="vary"):
        diagnose_draws(np.ones((4, 50, 10)))

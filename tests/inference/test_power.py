"""The smallest amplitude that is found, against closed forms and simulated estimates."""

import numpy as np
import pytest
from scipy import stats

from bayesfric.analysis import HalfNormal, Normal
from bayesfric.inference.power import (
    amplitude_error,
    log_bayes_factor,
    smallest_found,
    smallest_told_apart,
)

ERROR, WIDTH, TEN = 0.03, 0.2, float(np.log(10))


def closed_form(estimate, width, error):
    """N(Â; 0, σ² + p²) over N(Â; 0, σ²)."""
    wide = stats.norm.logpdf(estimate, 0, np.hypot(width, error))
    return wide - stats.norm.logpdf(estimate, 0, error)


@pytest.mark.parametrize("estimate", [0.0, 0.05, 0.4])
def test_bayes_factor_of_an_estimate(estimate):
    factor = log_bayes_factor(estimate, ERROR, Normal(mean=0.0, sd=WIDTH))
    assert factor == pytest.approx(closed_form(estimate, WIDTH, ERROR), abs=1e-6)
    # A half-normal has twice the density, on the side that the estimate leaves to it.
    half = log_bayes_factor(estimate, ERROR, HalfNormal(scale=WIDTH))
    shrunk = estimate * WIDTH / (ERROR * np.hypot(WIDTH, ERROR))
    expected = closed_form(estimate, WIDTH, ERROR) + np.log(2 * stats.norm.cdf(shrunk))
    assert half == pytest.approx(expected, abs=0.02)  # half a node at the cut


@pytest.mark.parametrize("prior", [Normal(mean=0.0, sd=WIDTH), HalfNormal(scale=WIDTH)])
def test_nine_of_ten_such_effects_are_found(prior):
    amplitude = smallest_found(ERROR, prior, TEN, 0.9)
    estimates = amplitude + ERROR * np.random.default_rng(1).standard_normal(4000)
    power = np.mean([log_bayes_factor(estimate, ERROR, prior) >= TEN for estimate in estimates])
    assert power == pytest.approx(0.9, abs=4 * np.sqrt(0.09 / 4000))


@pytest.mark.parametrize("odds", [TEN, 5.65])
@pytest.mark.parametrize("widths", [0.98, 1.45, 2.5, 4.4])
def test_a_poor_error_beside_a_narrow_prior(widths, odds):
    """Solved for the estimate at which the closed form is the odds, up to what data barely tell."""
    error = widths * WIDTH
    amplitude = smallest_found(error, Normal(mean=0.0, sd=WIDTH), odds, 0.9)
    shrink = WIDTH**2 / (WIDTH**2 + error**2)
    score = np.sqrt((2 * odds + np.log1p((WIDTH / error) ** 2)) / shrink)
    assert amplitude == pytest.approx(error * (score + stats.norm.ppf(0.9)), rel=1e-4)


@pytest.mark.parametrize("centre", [0.1, 0.0, -0.04])
def test_error_from_draws_of_a_posterior(centre):
    """Draws of likelihood times prior, on a grid: whole, and cut at zero."""
    rng = np.random.default_rng(2)
    precision = 1 / ERROR**2 + 1 / WIDTH**2
    mean, sd = centre / ERROR**2 / precision, precision**-0.5
    whole = rng.normal(mean, sd, 40_000)
    assert amplitude_error(whole, Normal(mean=0.0, sd=WIDTH)) == pytest.approx(ERROR, rel=0.03)
    cut = stats.truncnorm(-mean / sd, np.inf, mean, sd).rvs(40_000, random_state=rng)
    assert amplitude_error(cut, HalfNormal(scale=WIDTH)) == pytest.approx(ERROR, rel=0.12)


def test_an_amplitude_that_rests_on_its_prior_has_no_error():
    rng = np.random.default_rng(3)
    prior = Normal(mean=0.0, sd=WIDTH)
    assert amplitude_error(rng.normal(0.0, 0.99 * WIDTH, 5000), prior) is None


def test_an_effect_that_half_an_error_shows():
    """The threshold is what half an error gives: it is found there with probability one half."""
    prior = Normal(mean=0.0, sd=WIDTH)
    threshold = closed_form(0.5 * ERROR, WIDTH, ERROR)
    assert smallest_found(ERROR, prior, threshold, 0.5) == pytest.approx(0.5 * ERROR, rel=1e-4)


def test_a_prior_of_one_sign_is_taken_off():
    """Of a posterior far from zero: 1/σ² is the draws' precision less one over E A²."""
    rng = np.random.default_rng(4)
    cut = stats.truncnorm(-5.0, np.inf, 0.5, 0.1).rvs(40_000, random_state=rng)
    expected = (1 / cut.var() - 1 / 0.15**2) ** -0.5
    assert amplitude_error(cut, HalfNormal(scale=0.15)) == pytest.approx(expected, rel=0.01)


def test_draws_with_a_heavier_tail_than_any_normal_cut_at_zero():
    """The second moment over the square of the mean, 2 for the heaviest, is 10 here."""
    draws = np.concatenate([np.full(900, 1e-6), np.full(100, 1e-3)])
    assert amplitude_error(draws, HalfNormal(scale=WIDTH)) > draws.mean()


def test_two_effects_are_told_apart_as_often_as_asked():
    """Directions at 60°: that which acts has the larger projection by the odds, so often."""
    rng, odds = np.random.default_rng(5), np.log(9)
    first, second = np.array([1.0, 0.0]), np.array([0.5, np.sqrt(0.75)])
    error = 1 / np.sqrt(1 - (first @ second) ** 2)
    amplitude = smallest_told_apart(error, odds, 0.9)
    data = amplitude * first + rng.standard_normal((200_000, 2))
    ahead = 0.5 * ((data @ first) ** 2 - (data @ second) ** 2) > odds
    assert ahead.mean() == pytest.approx(0.9, abs=0.02)

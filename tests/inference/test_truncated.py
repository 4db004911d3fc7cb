"""Draws that a bound holds up are those of the density that is cut off there."""

import numpy as np
import pytest
from scipy.stats import kstest, truncnorm

from bayesfric.inference.truncated import drawn_above, drawn_above_zero, normal_above


@pytest.mark.parametrize("mean", [2.0, 0.3, -0.7, -3.0])
def test_moments_are_those_of_the_truncated_normal(mean):
    draws = np.random.default_rng(1).normal(mean, 1.0, (20_000, 1))
    truncated = drawn_above(draws, np.array([0.0]))[:, 0]
    exact = truncnorm(-mean, np.inf, loc=mean)
    assert truncated.min() >= 0
    # Of draws above the bound and others anew: a mixture of two samples of the same density.
    assert truncated.mean() == pytest.approx(exact.mean(), rel=0.03)
    assert truncated.std() == pytest.approx(exact.std(), rel=0.03)


def test_a_number_far_below_its_bound_is_off_by_as_much():
    """Data that have it at −1000 ± 1 are wrong by 1000: an interval of 1 above 0 is none."""
    draws = np.random.default_rng(2).normal(-1e3, 1.0, (2000, 1))
    truncated = drawn_above(draws, np.array([0.0]))
    assert np.isfinite(truncated).all()
    assert truncated.min() >= 0
    exact = truncnorm(4.0, np.inf, scale=250.0, loc=-1e3)
    assert truncated.mean() == pytest.approx(exact.mean(), rel=0.03)
    assert truncated.std() == pytest.approx(exact.std(), rel=0.05)
    mean, sd, quantiles = normal_above(-1e3, 1.0, 0.0)
    assert mean == pytest.approx(exact.mean())
    assert sd == pytest.approx(exact.std())
    assert quantiles == pytest.approx(np.quantile(truncated, [0.05, 0.5, 0.95]), rel=0.05)


def test_without_a_bound_and_above_it_nothing_changes():
    draws = np.random.default_rng(3).normal(5.0, 1.0, (300, 2))
    assert (drawn_above(draws, np.array([-np.inf, 0.0])) == draws).all()


def test_draws_that_are_alike_are_clipped():
    assert (drawn_above(np.full((4, 1), -1.0), np.array([0.5])) == 0.5).all()


@pytest.mark.parametrize("mean", [1.0, -0.5, -60.0])
def test_draws_above_zero_are_those_of_the_truncated_normal(mean):
    """At sixty standard deviations the part above zero underflows; its logarithm does not."""
    draws = drawn_above_zero(mean, 2.0, 2000, np.random.default_rng(3))
    assert kstest(draws, truncnorm(-mean / 2.0, np.inf, mean, 2.0).cdf).pvalue > 0.001

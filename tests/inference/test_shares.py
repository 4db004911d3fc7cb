"""A parameter whose prior is of its share of another: densities, draws and coordinates."""

import numpy as np
import pytest
from scipy import integrate, stats

from bayesfric.analysis import HalfCauchy, HalfNormal, LogNormal, Normal
from bayesfric.inference.model import Model
from bayesfric.inference.priors import Parameter

WHOLE = Parameter("c1", "1", HalfNormal(scale=0.01), "coefficient", power=1.0)
SHARE = Parameter("c3", "1/deg", Normal(mean=0.002, sd=0.005), power=1.0, share_of=WHOLE)
OTHER = Parameter("tau", "1", HalfNormal(scale=0.05), "scatter", power=0.5)


def model():
    return Model([], [WHOLE, OTHER, SHARE])


def test_a_draw_is_a_share_times_its_whole():
    theta = model().draw_prior(200_000, np.random.default_rng(3))
    share = theta[:, 2] / theta[:, 0]
    assert stats.kstest(share, stats.norm(0.002, 0.005).cdf).pvalue > 0.001
    assert abs(stats.spearmanr(share, theta[:, 0]).statistic) < 0.01


def test_the_log_prior_is_that_of_two_independent_numbers_by_a_change_of_variables():
    theta = np.array([[0.004, 0.02, 1e-5], [0.02, 0.1, -3e-5]])
    c1, tau, c3 = theta.T
    expected = (
        stats.halfnorm(scale=0.01).logpdf(c1)
        + stats.halfnorm(scale=0.05).logpdf(tau)
        + stats.norm(0.002 * c1, 0.005 * c1).logpdf(c3)
    )
    assert model().log_prior(theta) == pytest.approx(expected, rel=1e-12)
    assert model().log_priors(theta).sum(axis=1) == pytest.approx(expected, rel=1e-12)


def test_the_sampling_space_and_the_coordinates_come_back():
    z = np.random.default_rng(4).standard_normal((50, 3))
    theta = model().natural(z)
    assert model().sampling(theta) == pytest.approx(z, abs=1e-9)
    x = model().coordinates(z)
    assert x == pytest.approx(theta ** [1.0, 0.5, 1.0], rel=1e-12, nan_ok=True)
    assert model().from_coordinates(x) == pytest.approx(z, abs=1e-9)


def test_the_slope_of_the_coordinates_is_the_determinant_of_differences():
    z, step = np.array([[0.3, -0.5, 0.8]]), 1e-6
    rows = [
        (model().coordinates(z + step * unit) - model().coordinates(z - step * unit)) / (2 * step)
        for unit in np.eye(3)
    ]
    expected = np.linalg.slogdet(np.concatenate(rows))[1]
    assert model().coordinates_log_slope(z) == pytest.approx([expected], abs=1e-6)


def test_the_marginal_prior_is_the_integral_over_the_whole():
    value = np.array([-2e-5, 4e-6, 5e-5])

    def at(c1, c3):
        return stats.halfnorm(scale=0.01).pdf(c1) * stats.norm(0.002 * c1, 0.005 * c1).pdf(c3)

    expected = [integrate.quad(at, 1e-12, 0.1, args=(c3,), limit=500)[0] for c3 in value]
    assert SHARE.density(value) == pytest.approx(expected, rel=0.01)
    draws = model().draw_prior(400_000, np.random.default_rng(5))[:, 2]
    assert SHARE.sd() == pytest.approx(draws.std(), rel=0.01)
    assert SHARE.width() == SHARE.sd()
    assert SHARE.described() == "normal(mean=0.002, sd=0.005) of c1"


def test_a_share_without_a_standard_deviation_has_a_width():
    wide = Parameter("c3", "1/deg", HalfCauchy(scale=0.004), share_of=WHOLE)
    assert wide.sd() == np.inf
    low, high = stats.halfcauchy(scale=0.004).ppf(stats.norm.cdf([-1, 1]))
    assert wide.width() == pytest.approx(stats.halfnorm(scale=0.01).median() * (high - low) / 2)
    narrow = Parameter("c3", "1/deg", LogNormal(median=0.004, sd_log=0.1), share_of=WHOLE)
    assert narrow.sd() == pytest.approx(0.004 * 0.00603, rel=0.02)

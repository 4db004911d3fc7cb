"""Prior densities against SciPy's, their integrals, and what they may not know."""

import numpy as np
import pytest
from scipy import stats
from scipy.integrate import quad

from bayesfric.analysis import HalfNormal, LogNormal, Normal, Priors, Uniform
from bayesfric.inference.priors import draw, from_normal, log_density, prior_sd, quantile, to_normal
from bayesfric.paper import table1

CASES = [
    (HalfNormal(scale=0.3), stats.halfnorm(scale=0.3), (0.0, np.inf)),
    (LogNormal(median=0.7, sd_log=0.4), stats.lognorm(0.4, scale=0.7), (0.0, np.inf)),
    (Normal(mean=-0.2, sd=1.5), stats.norm(-0.2, 1.5), (-np.inf, np.inf)),
    (Uniform(low=-1.0, high=3.0), stats.uniform(-1.0, 4.0), (-1.0, 3.0)),
]


@pytest.mark.parametrize(("prior", "reference", "support"), CASES)
def test_density_is_scipys_and_integrates_to_one(prior, reference, support):
    x = np.array([-2.5, -0.7, 0.01, 0.4, 1.9, 3.5])
    assert log_density(prior, x) == pytest.approx(reference.logpdf(x), abs=1e-12)
    total = quad(lambda v: float(np.exp(log_density(prior, v))), *support, epsabs=1e-11)[0]
    assert total == pytest.approx(1.0, abs=1e-8)


@pytest.mark.parametrize(("prior", "reference", "support"), CASES)
def test_draws_quantiles_and_sd(prior, reference, support):
    assert prior_sd(prior) == pytest.approx(reference.std(), rel=1e-12)
    assert quantile(prior, [0.1, 0.9]) == pytest.approx(reference.ppf([0.1, 0.9]), rel=1e-12)
    draws = draw(prior, 2000, np.random.default_rng(1))
    assert stats.kstest(draws, reference.cdf).pvalue > 1e-3


@pytest.mark.parametrize(("prior", "reference", "support"), CASES)
def test_sampling_scale_has_the_quantiles_of_a_standard_normal(prior, reference, support):
    z = np.array([-7.0, -3.0, -0.5, -1e-3, 0.0, 1e-3, 0.5, 3.0, 7.0])
    if isinstance(prior, Uniform):
        z = z[np.abs(z) < 5]  # beyond, doubles near the upper bound have no digits left
    x = from_normal(prior, z)
    # From the nearer tail, where the probability has all its digits.
    assert reference.logcdf(x[z <= 0]) == pytest.approx(stats.norm.logcdf(z[z <= 0]), abs=1e-6)
    assert reference.logsf(x[z >= 0]) == pytest.approx(stats.norm.logsf(z[z >= 0]), abs=1e-6)
    assert to_normal(prior, x) == pytest.approx(z, abs=1e-8)
    bounds = [b for b in support if np.isfinite(b)]
    assert np.isinf(to_normal(prior, bounds)).all()


def test_sampling_scale_goes_on_where_tail_probabilities_underflow():
    """There a half-normal's quantile is a normal's with half the tail: u² = z² + 2 ln 2 − …"""
    prior = HalfNormal(scale=1e-4)
    z = np.array([29.999, 30.001, 37.0, 50.0, 5000.0])
    x = from_normal(prior, z)
    expected = np.sqrt(z**2 + 2 * np.log(2))
    assert x / 1e-4 == pytest.approx(expected, rel=1e-4)
    assert to_normal(prior, x) == pytest.approx(z, rel=1e-9)


def test_defaults_are_not_derived_from_table_1():
    """One default serves all sizes, and Table I is far inside each, not at its centre."""
    priors = Priors()
    assert priors.pulleys == {}
    for row in table1().values():
        assert 0.005 < stats.halfnorm(scale=priors.c1.scale).cdf(row.c1.value) < 0.5
        assert 0.005 < stats.halfnorm(scale=priors.c2.scale).cdf(row.c2.value) < 0.5
        assert abs(row.c3.value) < 0.1 * priors.c3.sd
    assert priors.c3.mean == 0.0


def test_table_1_is_read_with_its_rounding():
    small = table1()["small"]
    assert (small.c1.value, small.c2.value, small.c3.value) == (0.0128, 0.0261, 2.79e-5)
    assert small.c1.rounding == pytest.approx(0.5e-4)
    assert small.c3.rounding == pytest.approx(0.5e-7)
    assert table1()["large"].c3.rounding == pytest.approx(0.5e-8)
    assert small.radius_m == pytest.approx(0.0038)

"""Prior densities against SciPy's, their integrals, and what they may not know."""

import numpy as np
import pytest
from scipy import stats
from scipy.integrate import quad

from bayesfric.analysis import Analysis, Priors, checked_analysis
from bayesfric.errors import InputError
from bayesfric.families import (
    Beta,
    Gamma,
    HalfCauchy,
    HalfNormal,
    LogNormal,
    Normal,
    StudentT,
    TruncatedNormal,
    Uniform,
)
from bayesfric.inference.priors import (
    draw,
    from_normal,
    joined,
    log_density,
    prior_sd,
    prior_width,
    quantile,
    to_normal,
)
from bayesfric.paper import table1

CASES = [
    (HalfNormal(scale=0.3), stats.halfnorm(scale=0.3), (0.0, np.inf)),
    (LogNormal(median=0.7, sd_log=0.4), stats.lognorm(0.4, scale=0.7), (0.0, np.inf)),
    (Normal(mean=-0.2, sd=1.5), stats.norm(-0.2, 1.5), (-np.inf, np.inf)),
    (Uniform(low=-1.0, high=3.0), stats.uniform(-1.0, 4.0), (-1.0, 3.0)),
    (StudentT(3.5, -0.4, 0.6), stats.t(3.5, -0.4, 0.6), (-np.inf, np.inf)),
    (HalfCauchy(0.4), stats.halfcauchy(scale=0.4), (0.0, np.inf)),
    (Gamma(2.5, 0.3), stats.gamma(2.5, scale=0.3), (0.0, np.inf)),
    (Beta(2.0, 3.0, high=2.5), stats.beta(2.0, 3.0, scale=2.5), (0.0, 2.5)),
    (
        TruncatedNormal(0.5, 1.2, low=0.0),
        stats.truncnorm(-0.5 / 1.2, np.inf, 0.5, 1.2),
        (0, np.inf),
    ),
    (TruncatedNormal(-2.0, 1.0, 0.5, 1.5), stats.truncnorm(2.5, 3.5, -2.0, 1.0), (0.5, 1.5)),
    (TruncatedNormal(0.5, 1.2, -1.0, 1.0), stats.truncnorm(-1.25, 0.5 / 1.2, 0.5, 1.2), (-1, 1)),
]
BETWEEN_BOUNDS = (Uniform, Beta, TruncatedNormal)


@pytest.mark.parametrize(("prior", "reference", "support"), CASES)
def test_density_is_scipys_and_integrates_to_one(prior, reference, support):
    x = np.array([-2.5, -0.7, 0.01, 0.4, 1.9, 3.5])
    assert log_density(prior, x) == pytest.approx(reference.logpdf(x), abs=1e-12)
    total = quad(lambda v: float(np.exp(log_density(prior, v))), *support, epsabs=1e-11)[0]
    assert total == pytest.approx(1.0, abs=1e-8)


@pytest.mark.parametrize(("prior", "reference", "support"), CASES)
def test_draws_quantiles_and_sd(prior, reference, support):
    sd = reference.std()
    assert prior_sd(prior) == pytest.approx(sd if np.isfinite(sd) else np.inf, rel=1e-12)
    assert quantile(prior, [0.1, 0.9]) == pytest.approx(reference.ppf([0.1, 0.9]), rel=1e-12)
    draws = draw(prior, 2000, np.random.default_rng(1))
    assert stats.kstest(draws, reference.cdf).pvalue > 1e-3


@pytest.mark.parametrize(("prior", "reference", "support"), CASES)
def test_sampling_scale_has_the_quantiles_of_a_standard_normal(prior, reference, support):
    z = np.array([-7.0, -3.0, -0.5, -1e-3, 0.0, 1e-3, 0.5, 3.0, 7.0])
    if isinstance(prior, BETWEEN_BOUNDS):
        z = z[np.abs(z) < 5]  # beyond, doubles near the upper bound have no digits left
    x = from_normal(prior, z)
    # From the nearer tail, where the probability has all its digits.
    assert reference.logcdf(x[z <= 0]) == pytest.approx(stats.norm.logcdf(z[z <= 0]), abs=1e-6)
    assert reference.logsf(x[z >= 0]) == pytest.approx(stats.norm.logsf(z[z >= 0]), abs=1e-6)
    assert to_normal(prior, x) == pytest.approx(z, abs=1e-8)
    bounds = [b for b in support if np.isfinite(b)]
    assert np.isinf(to_normal(prior, bounds)).all()


@pytest.mark.parametrize(("prior", "reference", "support"), CASES)
def test_a_number_in_another_unit_has_the_same_quantiles(prior, reference, support):
    assert quantile(prior.times(50.0), [0.1, 0.5, 0.9]) == pytest.approx(
        50 * reference.ppf([0.1, 0.5, 0.9]), rel=1e-9
    )


@pytest.mark.parametrize(
    ("prior", "wider"),
    [
        (HalfNormal(0.3), HalfNormal(0.6)),
        (LogNormal(0.7, 0.4), LogNormal(0.7, 0.8)),
        (Normal(-0.2, 1.5), Normal(-0.2, 3.0)),
        (StudentT(3.5, -0.4, 0.6), StudentT(3.5, -0.4, 1.2)),
        (TruncatedNormal(0.5, 1.2, low=0.0), TruncatedNormal(0.5, 2.4, low=0.0)),
        (Uniform(-1.0, 3.0), Uniform(-1.0, 3.0)),
        (Beta(2.0, 3.0), Beta(2.0, 3.0)),
    ],
)
def test_twice_as_wide(prior, wider):
    assert prior.widened(2.0) == wider


@pytest.mark.parametrize(("prior", "reference", "support"), CASES)
def test_the_support_begins_where_it_says(prior, reference, support):
    assert prior.lowest == support[0]


def test_what_a_density_without_variance_is_as_wide_as():
    """Half the interval of 68 %: tan at 84 % and 16 % of a half-Cauchy density, by hand."""
    low, high = np.tan(np.pi / 2 * stats.norm.cdf([-1.0, 1.0]))
    assert prior_sd(HalfCauchy(2.0)) == np.inf
    assert prior_width(HalfCauchy(2.0)) == pytest.approx(high - low, rel=1e-9)
    assert prior_width(Gamma(4.0, 0.5)) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize(
    ("key", "prior", "said"),
    [
        ("tau", {"family": "normal", "mean": 0.0, "sd": 0.1}, "values above zero; normal has"),
        (
            "sigma_x",
            {"family": "student-t", "degrees_of_freedom": 3, "location": 0, "scale": 1},
            "values above zero; student-t has",
        ),
        ("omega", {"family": "uniform", "low": -0.1, "high": 0.1}, "values above zero"),
        ("c1", {"family": "truncated-normal", "mean": 0.0, "sd": 1.0}, "a low, a high, or both"),
        ("c1", {"family": "truncated-normal", "mean": 0.0, "sd": 1.0, "low": 20.0}, "within 8 sd"),
        (
            "c1",
            {"family": "truncated-normal", "mean": 0, "sd": 1, "low": 1, "high": 0},
            "above low",
        ),
        ("c1", {"family": "cauchy", "scale": 1.0}, "half-cauchy"),
        ("c1", {"family": "gamma", "shape": 2.0}, "expected this key"),
        ("c1", {"family": "beta", "a": -2.0, "b": 1.0}, "greater than 0"),
    ],
)
def test_what_is_no_density_is_refused_with_its_place(key, prior, said):
    with pytest.raises(InputError, match=said) as caught:
        checked_analysis({"priors": {key: prior}}, "analysis.toml")
    assert f"priors.{key}" in str(caught.value)


def test_a_file_names_every_family():
    families = {prior.family: prior for prior, _, _ in CASES}
    for name, prior in families.items():
        read = checked_analysis({"priors": {"c1": prior.model_dump(exclude_none=True)}}, "a.toml")
        assert read.priors.c1 == prior, name
    assert Analysis.model_validate_json(read.model_dump_json()) == read


def test_sampling_scale_goes_on_where_tail_probabilities_underflow():
    """There a half-normal's quantile is a normal's with half the tail: u² = z² + 2 ln 2 − …"""
    prior = HalfNormal(scale=1e-4)
    z = np.array([29.999, 30.001, 37.0, 50.0, 5000.0])
    x = from_normal(prior, z)
    expected = np.sqrt(z**2 + 2 * np.log(2))
    assert x / 1e-4 == pytest.approx(expected, rel=1e-4)
    assert to_normal(prior, x) == pytest.approx(z, rel=1e-9)


def test_defaults_are_not_derived_from_table_1():
    """One default serves all sizes, and Table I is inside each, not at its centre."""
    priors = Priors()
    assert priors.pulleys == {}
    for row in table1().values():
        assert 0.1 < stats.halfnorm(scale=priors.c1.scale).cdf(row.c1.value) < 0.9
        assert 0.1 < stats.halfnorm(scale=priors.c2.scale).cdf(row.c2.value) < 0.9
        assert abs(row.c3.value / row.c1.value) < priors.wrap_share.sd
    assert priors.wrap_share.mean == 0.0


def test_table_1_is_read_with_its_rounding():
    small = table1()["small"]
    assert (small.c1.value, small.c2.value, small.c3.value) == (0.0128, 0.0261, 2.79e-5)
    assert small.c1.rounding == pytest.approx(0.5e-4)
    assert small.c3.rounding == pytest.approx(0.5e-7)
    assert table1()["large"].c3.rounding == pytest.approx(0.5e-8)
    assert small.radius_m == pytest.approx(0.0038)


def test_priors_of_one_family_together_are_those_one_by_one():
    priors = [
        HalfNormal(0.05), LogNormal(0.1, 0.5), Normal(1.0, 2.0), HalfNormal(3.0), Gamma(2.0, 0.3),
        Uniform(-1.0, 4.0), Normal(-5.0, 0.1), LogNormal(7.0, 0.2), Gamma(3.0, 1.0),
    ]  # fmt: skip
    z = np.random.default_rng(3).normal(0.0, 2.0, (20, len(priors)))
    separately = np.stack(
        [from_normal(own_prior, z[:, k]) for k, own_prior in enumerate(priors)], axis=1
    )
    seen = []
    for places, prior in joined(priors):
        seen += places
        values = from_normal(prior, z[:, places])
        assert values == pytest.approx(separately[:, places], rel=1e-14)
        assert to_normal(prior, values) == pytest.approx(z[:, places], abs=1e-9)
        alone = np.stack([log_density(priors[k], separately[:, k]) for k in places], axis=1)
        assert log_density(prior, values) == pytest.approx(alone, rel=1e-12)
    assert sorted(seen) == list(range(len(priors)))
    assert len(joined(priors)) == 6  # those of SciPy stay apart

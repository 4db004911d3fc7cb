"""A fit with priors of other families: what it stores, and that the priors count as they should."""

import numpy as np
import pytest
from altered import by_acceleration, of_size, with_trials
from scipy import special, stats

from bayesfric.analysis import Analysis, Priors, Sampler
from bayesfric.families import Beta, Gamma, HalfCauchy, StudentT, TruncatedNormal
from bayesfric.fitting.posterior import fit

PRIORS = {
    "c1": (Gamma(2.0, 0.01), stats.gamma(2.0, scale=0.01)),
    "c2": (HalfCauchy(0.05), stats.halfcauchy(scale=0.05)),
    "c3": (StudentT(3.0, 0.0, 1e-4), stats.t(3.0, 0.0, 1e-4)),
    "tau": (Beta(1.0, 4.0, high=0.1), stats.beta(1.0, 4.0, scale=0.1)),
    "omega": (TruncatedNormal(0.01, 0.01, low=0.0), stats.truncnorm(-1.0, np.inf, 0.01, 0.01)),
}


def with_these(recording):
    priors = Priors(**{name: prior for name, (prior, _) in PRIORS.items()})
    sampler = Sampler(burn=10, steps=80, thin=3, extensions=0)  # as of the fit beside it
    return fit(recording, Analysis(seed=6, priors=priors, sampler=sampler))


@pytest.fixture(scope="module")
def fast_fit(small_recording):
    """Of one size, by accelerations."""
    small = with_trials(small_recording, of_size(small_recording, "small"))
    return with_these(by_acceleration(small))


def log_ratio(posterior):
    """Return the log density of these priors over that of the default ones, by SciPy."""
    default = {
        "c1": stats.halfnorm(scale=0.05),
        "c2": stats.halfnorm(scale=0.2),
        "c3": stats.norm(0.0, 1e-3),
        "tau": stats.halfnorm(scale=0.05),
        "omega": stats.halfnorm(scale=0.05),
    }
    terms = []
    for name, (_, prior) in PRIORS.items():
        values = posterior[name].to_numpy()
        term = prior.logpdf(values) - default[name].logpdf(values)
        terms.append(term.sum(axis=-1) if term.ndim == 3 else term)
    return sum(terms).ravel()


@pytest.mark.nightly
def test_posterior_is_the_default_one_reweighted_by_the_priors(small_fit, small_recording):
    other_fit = with_these(small_recording)
    before, after = (fitted.draws["posterior"] for fitted in (small_fit, other_fit))
    weight = special.softmax(log_ratio(before))
    assert 1 / (weight**2).sum() > 500  # effective draws of the weights
    for name in ("c1", "c2", "c3", "tau", "omega"):
        old = before[name].to_numpy().reshape(weight.size, -1)
        new = after[name].to_numpy().reshape(-1, old.shape[1])
        mean = weight @ old
        sd = np.sqrt(weight @ (old - mean) ** 2)
        assert np.abs(new.mean(axis=0) - mean) / sd == pytest.approx(0.0, abs=0.2), name
        assert new.std(axis=0) == pytest.approx(sd, rel=0.15), name


def test_what_is_stored_of_a_prior_without_standard_deviation(fast_fit):
    entry = fast_fit.summary.pulleys["small"]["c2"]
    assert entry.prior == "half-cauchy(scale=0.05)"
    assert entry.contraction is None
    assert entry.contraction_why == "the prior has no standard deviation"
    coefficient = fast_fit.summary.pulleys["small"]["c1"]
    assert coefficient.contraction == pytest.approx(
        1 - coefficient.sd / stats.gamma(2, scale=0.01).std()
    )


def test_prior_draws_and_log_prior_are_scipys(fast_fit):
    draws = fast_fit.draws
    prior = draws["prior"]
    for name, (_, reference) in PRIORS.items():
        assert stats.kstest(prior[name].to_numpy().ravel(), reference.cdf).pvalue > 1e-3, name
    assert np.isfinite(draws["prior_predictive"]["friction"].to_numpy()).all()
    stored = draws["log_prior"]["c2"].to_numpy()
    expected = stats.halfcauchy(scale=0.05).logpdf(draws["posterior"]["c2"].to_numpy())
    np.testing.assert_allclose(stored, expected, rtol=1e-10)

"""The density of draws at a point, against densities that are known."""

import numpy as np
import pytest
from inference import densities
from scipy import stats

from bayesfric.inference.evidence import LinearGaussian, bridge_evidence, savage_dickey

REPEATS = 40


def repeats(distribution, point, count=2000, repeats=REPEATS):
    """Actual errors of the log density at a point, and those reported."""
    found = [
        savage_dickey(
            distribution.rvs(count, random_state=np.random.default_rng(seed)).reshape(count, -1),
            np.atleast_1d(point).astype(float),
            0.0,
        )
        for seed in range(repeats)
    ]
    actual = np.array([f.log_evidence for f in found]) - distribution.logpdf(point)
    return actual, np.array([f.error for f in found]), {f.method for f in found}


@pytest.mark.parametrize(
    ("distribution", "point"),
    [
        (stats.norm(3.0, 0.01), 3.015),
        (stats.gamma(5), 9.0),
        (stats.loggamma(2), -0.5),
        (stats.multivariate_normal([0, 0], [[1, 0.8], [0.8, 1]]), [0.5, 1.0]),
    ],
    ids=["normal", "gamma", "log-gamma", "two"],
)
def test_density_among_the_draws(distribution, point):
    actual, reported, methods = repeats(distribution, point)
    assert methods == {"Savage–Dickey ratio"}
    assert 0.8 < np.sqrt(np.mean((actual / reported) ** 2)) < 1.3
    assert reported.mean() < 0.15


@pytest.mark.parametrize(
    ("distribution", "point"),
    [(stats.norm(), 4.5), (stats.gamma(5), 16.0), (stats.t(5), 5.5)],
    ids=["normal", "gamma", "t"],
)
def test_density_beyond_the_draws_says_so(distribution, point):
    _, reported, methods = repeats(distribution, point, repeats=5)
    assert methods == {"Savage–Dickey ratio, beyond the draws"}
    assert (reported == np.inf).all()


def test_peak_of_a_heavy_density_is_hardly_smoothed():
    """The normal start is wrong here, and only the kernel estimate mends it."""
    actual, _, _ = repeats(stats.t(5), 0.0)
    assert abs(actual.mean()) < 0.05
    start = stats.norm(0, stats.t(5).std()).logpdf(0.0) - stats.t(5).logpdf(0.0)
    assert abs(start) > 0.2


def test_tail_of_a_normal_is_followed_beyond_the_draws():
    actual, _, _ = repeats(stats.norm(), 5.0)
    assert abs(actual.mean()) < 0.5  # of −13.4


def test_bayes_factor_of_nested_linear_models():
    """The ratio is that of the closed evidences."""
    rng = np.random.default_rng(1)
    design = rng.normal(size=(20, 3))
    measured = design @ np.array([0.5, 1.0, 0.1]) + rng.normal(size=20)
    wide = LinearGaussian(design, np.ones(3), np.eye(20))
    narrow = LinearGaussian(design[:, :2], np.ones(2), np.eye(20))
    truth = narrow.log_evidence(measured) - wide.log_evidence(measured)
    mean, covariance = wide.posterior(measured)
    errors, ratios = [], []
    for _ in range(REPEATS):
        draws = rng.multivariate_normal(mean, covariance, size=2000)[:, 2:]
        found = savage_dickey(draws, np.zeros(1), float(stats.norm.logpdf(0.0)))
        errors.append(found.log_evidence - truth)
        ratios.append(errors[-1] / found.error)
    assert 0.8 < np.sqrt(np.mean(np.square(ratios))) < 1.3
    assert abs(np.mean(errors)) < 4 * np.std(errors) / np.sqrt(REPEATS)  # of a normal: no bias


def test_bayes_factor_agrees_with_bridges():
    """Independent ways to one number: a bent density with its first coordinate held."""
    wide = densities.banana(3)
    draws = wide.chains(1)
    bridged = bridge_evidence(wide.log_density, draws, 1)

    def held(z):
        return wide.log_density(np.concatenate([np.full((len(z), 1), 0.7), z], axis=1))

    rng = np.random.default_rng(2)
    inside = rng.standard_normal((4, 60, 30, 2)) + np.array([0.4 * (0.7**2 - 1), 0])
    narrow = bridge_evidence(held, inside, 2)
    first = draws[..., 0].reshape(-1, 1)
    found = savage_dickey(first, np.array([0.7]), 0.0)
    error = np.sqrt(bridged.error**2 + narrow.error**2 + found.error**2)
    assert abs(found.log_evidence - (narrow.log_evidence - bridged.log_evidence)) < 3 * error


def test_dependent_draws_have_larger_errors():
    fresh = np.random.default_rng(3).standard_normal((400, 1))
    once = savage_dickey(fresh, np.zeros(1), 0.0)
    again = savage_dickey(np.repeat(fresh, 10, axis=0), np.zeros(1), 0.0)
    assert again.error > 0.6 * once.error


@pytest.mark.parametrize(
    ("draws", "point"),
    [
        (np.zeros((399, 1)), np.zeros(1)),
        (np.zeros((500, 2)), np.zeros(1)),
        (np.full((500, 1), np.inf), np.zeros(1)),
    ],
)
def test_bad_draws_are_refused(draws, point):
    with pytest.raises(ValueError, match="must be finite, at least 400"):
        savage_dickey(draws, point, 0.0)

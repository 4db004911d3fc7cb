"""The evidence by importance sampling around the mode."""

import numpy as np
import pytest
from inference import densities
from inference.test_sampling import EXPONENTIAL, skewed
from scipy.special import digamma, gammaln, polygamma

from bayesfric.inference.evidence.importance import importance_draws
from bayesfric.inference.laplace import Laplace, laplace_approximation


@pytest.mark.parametrize(
    "density",
    [densities.conjugate(5), densities.conjugate(12), densities.log_gammas(5)],
    ids=["conjugate 5", "conjugate 12", "skewed"],
)
def test_known_integrals(density):
    estimate, draws = importance_draws(density.log_density, density.laplace(), 1)
    assert estimate.pareto_k < 0.7
    assert estimate.error < np.sqrt(3 / 4000)  # a quarter of the sample counts
    assert abs(estimate.log_evidence - density.log_evidence) < 3 * estimate.error
    assert draws.shape == (4000, density.size)


@pytest.mark.parametrize("density", [densities.log_gammas(5), densities.student(4, freedom=8.0)])
def test_errors_are_as_large_as_reported(density):
    laplace = density.laplace()
    estimates = [importance_draws(density.log_density, laplace, seed)[0] for seed in range(100)]
    ratio = [(f.log_evidence - density.log_evidence) / f.error for f in estimates]
    assert 0.8 < np.sqrt(np.mean(np.square(ratio))) < 1.3


def test_a_proposal_that_is_far_off_is_fitted_anew():
    density, laplace = densities.conjugate(4), densities.conjugate(4).laplace()
    root = np.sqrt(np.diag(laplace.covariance))
    off = Laplace(laplace.mode + 1.5 * root, 0.3 * laplace.covariance, laplace.log_density)
    estimate = importance_draws(density.log_density, off, 1)[0]
    assert estimate.error < np.sqrt(3 / 4000)  # a quarter of the sample counts
    assert abs(estimate.log_evidence - density.log_evidence) < 3 * estimate.error


def test_the_integral_is_the_same_in_another_chart():
    """In e^z the first coordinate is gamma(2); the second half of the others is a ridge."""
    laplace = laplace_approximation(skewed, np.zeros(3), np.ones(3))
    plain = importance_draws(skewed, laplace, 1)[0]
    bent = importance_draws(skewed, laplace, 1, EXPONENTIAL)[0]
    assert plain != bent
    # e^(2z − e^z) integrates to Γ(2); the ridge of −z²/2 − ((w − z)/0.1)²/2 to 0.1 · 2π.
    expected = float(gammaln(2.0)) + np.log(0.1 * 2 * np.pi)
    for estimate in (plain, bent):
        assert abs(estimate.log_evidence - expected) < 3 * estimate.error


def test_draws_have_the_moments_of_the_density():
    density = densities.conjugate(5)
    laplace = density.laplace()
    draws = importance_draws(density.log_density, laplace, 3)[1]
    error = np.sqrt(np.diag(laplace.covariance) / 2000)  # at least half of the points count
    assert np.abs((draws.mean(axis=0) - laplace.mode) / error).max() < 4
    assert draws.std(axis=0) == pytest.approx(np.sqrt(np.diag(laplace.covariance)), rel=0.07)


def test_weights_without_a_mean_give_no_evidence():
    """A density with tails heavier than any proposal's."""

    def log_density(z):
        return -np.log1p(z**2 / 1e-4).sum(axis=1) * 0.55

    assert importance_draws(log_density, Laplace(np.zeros(2), 1e-4 * np.eye(2), 0.0), 1) is None


def test_no_density_around_the_mode_gives_no_evidence():
    nowhere = Laplace(np.zeros(2), np.eye(2), 0.0)
    assert importance_draws(lambda z: np.full(len(z), -np.inf), nowhere, 1) is None


def test_one_seed_one_result():
    density, laplace = densities.log_gammas(3), densities.log_gammas(3).laplace()
    first, again, other = (importance_draws(density.log_density, laplace, s)[0] for s in (1, 1, 2))
    assert first == again
    assert first != other


def test_many_numbers_take_a_larger_sample():
    """Logarithms of 26 gammas, of which too few of 1,000 points count for a covariance."""
    shape, count = 2.5, 26
    laplace = Laplace(np.full(count, np.log(shape)), np.eye(count) / shape, 0.0)

    def log_density(z):
        return (shape * z - np.exp(z) - gammaln(shape)).sum(axis=1)

    assert importance_draws(log_density, laplace, 1, least_effective=0.1) is None
    estimate, draws = importance_draws(log_density, laplace, 1, least_effective=0.1, points=4000)
    assert abs(estimate.log_evidence) < 3 * estimate.error
    off = (draws.mean(axis=0) - digamma(shape)) / np.sqrt(polygamma(1, shape))
    assert np.abs(off).max() < 4 * np.hypot(estimate.error, 1 / np.sqrt(4000))

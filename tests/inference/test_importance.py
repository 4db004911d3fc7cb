"""The quick screen: importance sampling around the mode."""

import numpy as np
import pytest
from inference import densities
from scipy import stats

from bayesfric.inference.evidence import Evidence, agree, laplace_draws, reliable_draws
from bayesfric.inference.laplace import Laplace


@pytest.mark.parametrize(
    "known",
    [densities.conjugate(5), densities.conjugate(12), densities.log_gammas(5)],
    ids=["conjugate 5", "conjugate 12", "skewed"],
)
def test_known_integrals(known):
    found = laplace_draws(known.log_density, known.laplace(), 1)[0]
    assert found.reliable
    assert found.pareto_k < 0.7
    assert found.error < 0.06
    assert abs(found.log_evidence - known.log_evidence) < 3 * found.error


def test_errors_are_as_large_as_reported():
    known = densities.log_gammas(5)
    laplace = known.laplace()
    found = [laplace_draws(known.log_density, laplace, seed)[0] for seed in range(100)]
    ratio = [(f.log_evidence - known.log_evidence) / f.error for f in found]
    assert 0.8 < np.sqrt(np.mean(np.square(ratio))) < 1.3


def test_a_proposal_that_is_far_off_is_fitted_anew():
    known, laplace = densities.conjugate(4), densities.conjugate(4).laplace()
    root = np.sqrt(np.diag(laplace.covariance))
    off = Laplace(laplace.mode + 1.5 * root, 0.3 * laplace.covariance, laplace.log_density)
    points = []

    def counted(z):
        points.append(len(z))
        return known.log_density(z)

    found = laplace_draws(counted, off, 1, size=3000)[0]
    assert sum(points) == 6000
    assert max(points) <= 512
    assert found.reliable
    assert abs(found.log_evidence - known.log_evidence) < 3 * found.error


def test_weights_without_a_mean_are_unreliable():
    """A density with tails heavier than any proposal's."""

    def log_density(z):
        return -np.log1p(z**2 / 1e-4).sum(axis=1) * 0.55

    narrow = Laplace(np.zeros(2), 1e-4 * np.eye(2), 0.0)
    found = laplace_draws(log_density, narrow, 1)[0]
    assert found.pareto_k > 0.7
    assert found.error == float("inf")
    assert not found.reliable
    assert reliable_draws(log_density, narrow, 1) is None


def test_a_sample_that_looks_too_heavy_is_drawn_again_larger():
    """Student's t with 2 degrees of freedom: weights have a mean, as most samples show."""
    student = stats.multivariate_t(np.zeros(3), np.eye(3), df=2)
    around = Laplace(np.zeros(3), 0.4 * np.eye(3), 2.0 + float(student.logpdf(np.zeros(3))))

    def log_density(z):
        return 2.0 + student.logpdf(z)

    assert not laplace_draws(log_density, around, 14)[0].reliable
    found, draws = reliable_draws(log_density, around, 14)
    assert abs(found.log_evidence - 2.0) < 3 * found.error
    assert len(draws) == 4000
    at_once, draws = reliable_draws(log_density, around, 0)
    assert at_once == laplace_draws(log_density, around, 0)[0]
    assert len(draws) == 2000


def test_one_seed_one_result():
    known, laplace = densities.log_gammas(3), densities.log_gammas(3).laplace()
    first, again, other = (laplace_draws(known.log_density, laplace, s)[0] for s in (1, 1, 2))
    assert first == again
    assert first != other


def test_too_small_a_sample_is_refused():
    known = densities.log_gammas(2)
    with pytest.raises(ValueError, match="at least 200"):
        laplace_draws(known.log_density, known.laplace(), 1, size=199)[0]


def test_no_density_anywhere_is_refused():
    with pytest.raises(ValueError, match="zero all around"):
        laplace_draws(lambda z: np.full(len(z), -np.inf), Laplace(np.zeros(2), np.eye(2), 0.0), 1)


@pytest.mark.parametrize(
    ("apart", "error", "expected"),
    [(0.49, 0.1, True), (0.51, 0.1, False), (0.1, float("inf"), False)],
)
def test_agreement_is_three_combined_errors(apart, error, expected):
    first = Evidence(5.0, np.sqrt((0.5 / 3) ** 2 - 0.01), "one")
    assert agree(first, Evidence(5.0 + apart, error, "other")) is expected
    assert agree(Evidence(5.0 + apart, error, "other"), first) is expected

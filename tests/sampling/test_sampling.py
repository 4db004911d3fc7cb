"""Draws of densities whose quantiles are known; seeds; Hastings factor; refusals."""

import numpy as np
import pytest
from scipy import stats

from bayesfric.analysis import Sampler
from bayesfric.laplace import Laplace, laplace_approximation
from bayesfric.sampling import SamplingError, StudentT, sample

SETTINGS = Sampler(walkers=32, burn=100, steps=400, thin=4)


def skewed(points):
    """Three correlated coordinates, one of them a log-gamma: far from a Student-t."""
    z, x, y = points.T
    return 2 * z - np.exp(z) + stats.norm(0.5 * z, 1.0).logpdf(x) + stats.norm(x, 0.1).logpdf(y)


def draw(seed, progress=None):
    laplace = laplace_approximation(skewed, np.zeros(3), np.ones(3))
    return sample(skewed, laplace, SETTINGS, seed, progress)


def test_quantiles_are_those_of_the_density():
    z = draw(1).z[..., 0].ravel()
    # e^z is gamma(2): its quantiles, and the Monte Carlo error of 12,800 draws
    # of which at least every fourth counts.
    for probability in (0.05, 0.25, 0.5, 0.75, 0.95):
        below = (np.exp(z) < stats.gamma(2).ppf(probability)).mean()
        error = np.sqrt(probability * (1 - probability) / 3200)
        assert abs(below - probability) < 4 * error


def test_correlation_is_that_of_the_density():
    _, x, y = draw(2).z.reshape(-1, 3).T
    assert (y - x).std() == pytest.approx(0.1, rel=0.05)
    # Var x = Var(z)/4 + 1 with Var(z) = trigamma(2) = π²/6 − 1.
    assert x.var() == pytest.approx((np.pi**2 / 6 - 1) / 4 + 1, rel=0.08)


def test_one_seed_one_result():
    first, again, other = draw(3), draw(3), draw(4)
    assert (first.z == again.z).all()
    assert (first.log_density == again.log_density).all()
    assert not (first.z == other.z).all()


def test_ensembles_differ_and_are_kept_apart():
    draws = draw(5)
    assert draws.z.shape == (4, 100, 32, 3)
    assert len({draws.z[ensemble, 0, 0, 0] for ensemble in range(4)}) == 4
    recomputed = skewed(draws.z.reshape(-1, 3))
    assert draws.log_density.ravel() == pytest.approx(recomputed, abs=1e-12)


def test_progress_counts_every_step_once():
    seen = []
    draw(6, lambda done, total: seen.append((done, total)))
    total = 100 + 4 * 500
    assert seen == [(step, total) for step in range(1, total + 1)]


def test_student_t_density_and_draws_are_scipys():
    scale = np.array([[2.0, 0.5], [0.5, 1.0]])
    mine = StudentT(np.array([1.0, -1.0]), scale, 6.0)
    reference = stats.multivariate_t(np.array([1.0, -1.0]), scale, df=6.0)
    points = np.array([[0.0, 0.0], [4.0, -3.0], [1.0, -1.0]])
    assert mine.log_density(points) == pytest.approx(reference.logpdf(points), abs=1e-12)
    drawn = mine.draw(20_000, np.random.RandomState(1))
    assert np.cov(drawn.T) == pytest.approx(scale * 6 / 4, rel=0.1)


def test_proposal_returns_its_hastings_factor():
    proposal = StudentT(np.zeros(1), np.eye(1), 6.0)
    here = np.array([[3.0]])
    there, factor = proposal.propose(here, np.random.RandomState(2))
    t = stats.t(6.0)
    assert factor[0] == pytest.approx(t.logpdf(3.0) - t.logpdf(there[0, 0]), abs=1e-12)


def test_sampler_that_cannot_start_says_what_it_saw():
    laplace = Laplace(np.array([0.5]), np.eye(1), 0.0)
    with pytest.raises(SamplingError, match=r"only \d+ of 640 points around the mode \[0.5\]"):
        sample(
            lambda z: np.where((z[:, 0] > 0.49) & (z[:, 0] < 0.51), 0.0, -np.inf),
            laplace,
            SETTINGS,
            seed=0,
        )

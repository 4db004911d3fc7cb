"""Draws of densities whose quantiles are known; seeds; Hastings factor; refusals."""

import numpy as np
import pytest
from scipy import stats

from bayesfric.analysis import Sampler
from bayesfric.checkpoint import Checkpoint
from bayesfric.inference.laplace import Laplace, laplace_approximation
from bayesfric.inference.proposals import (
    SAMPLING_SPACE,
    Chart,
    Proposal,
    StudentT,
    importance_points,
    more_points,
    resampled,
)
from bayesfric.inference.samplers import SamplingError
from bayesfric.inference.sampling import sample

SETTINGS = Sampler(walkers=32, burn=100, steps=400, thin=4)
SHORT = Sampler(walkers=32, burn=50, steps=100, thin=4)  # where no quantile is asked for


def skewed(points):
    """Three correlated coordinates, one of them a log-gamma: far from a Student-t."""
    z, x, y = points.T
    return 2 * z - np.exp(z) - 0.5 * (x - 0.5 * z) ** 2 - 0.5 * ((y - x) / 0.1) ** 2


def draw(seed, progress=None, settings=SETTINGS, **options):
    laplace = laplace_approximation(skewed, np.zeros(3), np.ones(3))
    return sample(skewed, laplace, settings, seed, progress, **options)


def exponential(z):
    return np.column_stack([np.exp(z[:, 0]), z[:, 1:]])


def logarithm(x):
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.column_stack([np.log(x[:, 0]), x[:, 1:]])


EXPONENTIAL = Chart(exponential, logarithm, lambda z: z[:, 0])


@pytest.fixture(scope="module")
def drawn():
    """Draws whose quantiles are read; no test changes them."""
    return draw(1)


def test_quantiles_are_those_of_the_density(drawn):
    z = drawn.z[..., 0].ravel()
    # e^z is gamma(2): its quantiles, and the Monte Carlo error of 12,800 draws
    # of which at least every fourth counts.
    for probability in (0.05, 0.25, 0.5, 0.75, 0.95):
        below = (np.exp(z) < stats.gamma(2).ppf(probability)).mean()
        error = np.sqrt(probability * (1 - probability) / 3200)
        assert abs(below - probability) < 4 * error


def test_correlation_is_that_of_the_density(drawn):
    _, x, y = drawn.z.reshape(-1, 3).T
    assert (y - x).std() == pytest.approx(0.1, rel=0.05)
    # Var x = Var(z)/4 + 1 with Var(z) = trigamma(2) = π²/6 − 1.
    assert x.var() == pytest.approx((np.pi**2 / 6 - 1) / 4 + 1, rel=0.08)


def test_one_seed_one_result():
    first, again, other = (draw(seed, settings=SHORT) for seed in (3, 3, 4))
    assert (first.z == again.z).all()
    assert (first.log_density == again.log_density).all()
    assert not (first.z == other.z).all()


def test_ensembles_differ_and_are_kept_apart():
    draws = draw(5, settings=SHORT)
    assert draws.z.shape == (4, 25, 32, 3)
    assert len({draws.z[ensemble, 0, 0, 0] for ensemble in range(4)}) == 4
    recomputed = skewed(draws.z.reshape(-1, 3))
    assert draws.log_density.ravel() == pytest.approx(recomputed, abs=1e-12)


def test_progress_counts_every_step_once():
    seen = []
    draw(6, lambda done, total: seen.append((done, total)), SHORT)
    total = 4 * 150  # an importance sample, then the ensembles
    assert seen == [(step, total) for step in range(1, total + 1)]


def never(z):
    return False


@pytest.mark.parametrize("share", [0.9, 1.0])
def test_a_chart_changes_the_proposals_and_not_the_density(share, drawn):
    """With proposals below zero in it, where no point is; also without other moves."""
    settings = SETTINGS.model_copy(update={"extensions": 1, "independence_share": share})
    draws = draw(1, settings=settings, converged=never, chart=EXPONENTIAL)
    z, x, _ = draws.z.reshape(-1, 3).T
    for probability in (0.05, 0.25, 0.5, 0.75, 0.95):
        below = (np.exp(z) < stats.gamma(2).ppf(probability)).mean()
        error = np.sqrt(probability * (1 - probability) / 3200)
        assert abs(below - probability) < 4 * error
    assert x.var() == pytest.approx((np.pi**2 / 6 - 1) / 4 + 1, rel=0.08)
    assert not (z == drawn.z[..., 0].ravel()).any()


@pytest.mark.parametrize(
    ("enough", "extensions", "steps"), [(1, 0, 100), (2, 1, 100), (3, 2, 200), (9, 3, 400)]
)
def test_ensembles_run_on_until_the_draws_are_good(enough, extensions, steps):
    asked, seen = [], []

    def converged(z):
        asked.append(z.shape)
        return len(asked) == enough

    def progress(done, total):
        seen.append((done, total))

    settings = SHORT.model_copy(update={"extensions": 3})
    draws = draw(5, progress, settings, converged=converged)
    assert (draws.extensions, draws.steps, draws.thin) == (extensions, steps, steps // 25)
    assert set(asked) == {(4, 25, 32, 3)}  # as many draws each time
    assert [done for done, _ in seen] == list(range(1, len(seen) + 1))
    assert seen[-1][0] == seen[-1][1] == 4 * (50 + 100 * 2**extensions)


def test_draws_that_are_good_are_left_alone():
    draws = draw(5, settings=SHORT, converged=lambda z: True, chart=EXPONENTIAL)
    assert draws.extensions == 0
    assert (draws.z == draw(5, settings=SHORT, chart=EXPONENTIAL).z).all()


def test_a_run_that_was_stopped_while_it_ran_on_goes_on_to_the_same_draws(tmp_path):
    settings = SHORT.model_copy(update={"extensions": 2})
    again_and_again = {"settings": settings, "converged": never, "chart": EXPONENTIAL}
    unbroken = draw(5, **again_and_again)

    def stop(done, total):
        if done == 1061:  # in the second extension
            raise KeyboardInterrupt

    keeping = Checkpoint(tmp_path / "c", "key")
    with pytest.raises(KeyboardInterrupt):
        draw(5, stop, checkpoint=keeping, **again_and_again)
    assert list((tmp_path / "c").glob("ensemble-0-000250.npz"))
    seen = []
    again = draw(5, lambda done, total: seen.append(done), checkpoint=keeping, **again_and_again)
    assert (again.z == unbroken.z).all()
    assert (again.acceptance == unbroken.acceptance).all()
    assert seen == sorted(set(seen))


def cauchy(z):
    """Six coordinates, each of them Cauchy: no Student-t of the proposals has such tails."""
    return -np.log1p(z**2).sum(axis=1)


def test_importance_points_have_the_moments_of_the_density():
    laplace = laplace_approximation(skewed, np.zeros(3), np.ones(3))
    points = importance_points(skewed, laplace, EXPONENTIAL, np.random.RandomState(1))
    assert points.shape == (1000, 3)
    # e^z is gamma(2), of mean 2 and variance 2; at least a quarter of the points counts.
    assert np.exp(points[:, 0]).mean() == pytest.approx(2.0, abs=4 * np.sqrt(2 / 250))
    assert (points[:, 2] - points[:, 1]).std() == pytest.approx(0.1, rel=4 / np.sqrt(2 * 250))


AROUND_CAUCHY = Laplace(np.zeros(6), np.eye(6), 0.0)


def test_no_importance_points_are_returned_that_cannot_be_relied_on():
    assert (
        importance_points(cauchy, AROUND_CAUCHY, SAMPLING_SPACE, np.random.RandomState(1)) is None
    )


def test_a_larger_sample_is_drawn_around_a_smaller_one():
    """A proposal of 16 numbers that is fitted to it covers the density better."""
    covariance = np.eye(16) + 0.9
    precision = np.linalg.inv(covariance)

    def normal(z):
        return -0.5 * np.einsum("wi,ij,wj->w", z, precision, z)

    def effective(points):
        proposal = Proposal.around(points, SAMPLING_SPACE)
        z, _ = proposal.draw(4000, np.random.RandomState(3))
        weights = np.exp(normal(z) - proposal.log_density(z))
        return weights.sum() ** 2 / (weights**2).sum() / len(z)

    rng = np.random.RandomState(2)
    few = rng.multivariate_normal(np.zeros(16), covariance, 300)
    more = more_points(normal, few, SAMPLING_SPACE, rng, 2000)
    assert more.shape == (2000, 16)
    assert np.cov(more, rowvar=False) == pytest.approx(covariance, abs=0.35)
    assert effective(more) > 1.2 * effective(few)


def test_points_stay_where_a_larger_sample_is_not_to_be_relied_on():
    few = np.random.RandomState(1).standard_normal((100, 6))
    assert more_points(cauchy, few, SAMPLING_SPACE, np.random.RandomState(1), 2000) is few


def test_no_proposal_is_fitted_to_fewer_points_than_a_covariance_needs():
    """Only in a corner of six coordinates is any point possible, and few are drawn there."""
    possible = []

    def corner(z):
        inside = (z < -0.4).all(axis=1)
        possible.append(np.count_nonzero(inside))
        return np.where(inside, 0.0, -np.inf)

    rng = np.random.RandomState(1)
    assert importance_points(corner, AROUND_CAUCHY, SAMPLING_SPACE, rng) is None
    assert len(possible) == 1
    assert 1 <= possible[0] < 6


def test_pilots_stand_in_where_importance_is_not_to_be_relied_on():
    seen = []
    draws = sample(
        cauchy, AROUND_CAUCHY, SETTINGS, 7, lambda done, total: seen.append((done, total))
    )
    total = 100 + 200 + 400 + 4 * 500  # three pilots, then the ensembles
    assert seen == [(step, total) for step in range(1, total + 1)]
    # Half of a Cauchy distribution lies within one of its centre; a twentieth of the draws counts.
    within = (np.abs(draws.z.reshape(-1, 6)) < 1).mean(axis=0)
    assert within == pytest.approx(0.5, abs=4 * np.sqrt(0.25 / 640))


def test_a_proposal_in_a_chart_has_the_density_of_its_draws():
    """A normal density in e^z: that of z has the derivative beside it."""
    proposal = Proposal(StudentT(np.full(1, 3.0), np.eye(1), 48.0), EXPONENTIAL)
    z, possible = proposal.draw(20_000, np.random.RandomState(3))
    assert not possible.all()  # some draws are below zero, where no point is
    grid = np.linspace(-8, 4, 4001)
    density = np.exp(proposal.log_density(grid[:, None]))
    above_zero = stats.t(48.0, 3.0, 1.0).sf(0.0)
    assert np.trapezoid(density, grid) == pytest.approx(above_zero, rel=1e-4)
    assert possible.mean() == pytest.approx(above_zero, abs=1e-3)
    mean = np.trapezoid(density * grid, grid) / above_zero
    assert z[possible].mean() == pytest.approx(mean, abs=0.02)


def test_student_t_density_and_draws_are_scipys():
    scale = np.array([[2.0, 0.5], [0.5, 1.0]])
    mine = StudentT(np.array([1.0, -1.0]), scale, 6.0)
    reference = stats.multivariate_t(np.array([1.0, -1.0]), scale, df=6.0)
    points = np.array([[0.0, 0.0], [4.0, -3.0], [1.0, -1.0]])
    assert mine.log_density(points) == pytest.approx(reference.logpdf(points), abs=1e-12)
    drawn = mine.draw(20_000, np.random.RandomState(1))
    assert np.cov(drawn.T) == pytest.approx(scale * 6 / 4, rel=0.1)


def test_proposal_returns_its_hastings_factor():
    proposal = Proposal(StudentT(np.zeros(1), np.eye(1), 6.0))
    start = np.array([[3.0]])
    there, factor = proposal.propose(start, np.random.RandomState(2))
    t = stats.t(6.0)
    assert factor[0] == pytest.approx(t.logpdf(3.0) - t.logpdf(there[0, 0]), abs=1e-12)


def test_sampler_that_cannot_start_says_what_it_saw():
    laplace = Laplace(np.array([0.5]), np.eye(1), 0.0)
    with pytest.raises(SamplingError, match=r"only \d+ of 640 points around \[0.5\]"):
        sample(
            lambda z: np.where(np.abs(z[:, 0] - 0.5) < 1e-6, 0.0, -np.inf),
            laplace,
            SETTINGS,
            seed=0,
        )


def test_a_student_twice_as_wide():
    location, scale = np.array([1.0, -2.0]), np.array([[2.0, 0.5], [0.5, 1.0]])
    points = np.random.default_rng(5).standard_normal((6, 2))
    expected = stats.multivariate_t(location, 4 * scale, df=6).logpdf(points)
    log_densities = StudentT(location, scale, 24.0).wider(2.0).log_density(points)
    assert log_densities == pytest.approx(expected, rel=1e-10)


def test_a_linear_chart_carries_the_covariance_over():
    matrix, shift = np.array([[2.0, 0.0], [1.0, 3.0]]), np.array([0.5, -1.0])
    chart = Chart(lambda z: z @ matrix.T, lambda x: x @ np.linalg.inv(matrix).T, None)
    covariance = np.array([[0.04, 0.01], [0.01, 0.09]])
    student = Proposal.at_mode(Laplace(shift, covariance, 0.0), chart).student
    points = np.random.default_rng(6).standard_normal((6, 2))
    scale = matrix @ covariance @ matrix.T
    expected = stats.multivariate_t(matrix @ shift, scale, df=6).logpdf(points)
    assert student.log_density(points) == pytest.approx(expected, rel=1e-8)


@pytest.mark.parametrize("seed", range(5))
def test_points_are_drawn_as_often_as_their_weights_say(seed):
    rng = np.random.default_rng(seed)
    assert resampled(np.ones(7), 7, rng).tolist() == list(range(7))
    assert resampled(np.array([1.0, 0.0, 3.0]), 4, rng).tolist() == [0, 2, 2, 2]


@pytest.mark.parametrize("ending", [KeyboardInterrupt, SystemExit, ZeroDivisionError])
def test_what_ends_a_call_of_the_density_is_raised_and_nothing_is_printed(capfd, ending):
    """As where Ctrl-C falls into the density, which is where most of the time goes."""
    laplace = laplace_approximation(skewed, np.zeros(3), np.ones(3))
    reported = []

    def density(points):
        if reported:  # the ensembles are moving
            raise ending
        return skewed(points)

    with pytest.raises(ending):
        sample(density, laplace, SHORT, 1, lambda done, total: reported.append(done))
    assert capfd.readouterr() == ("", "")

"""Leave-one-group-out from draws, against the closed form of a conjugate model."""

import tracemalloc

import numpy as np
import pytest
from inference.conjugate import LinearGaussian
from scipy import stats

from bayesfric.inference.evidence.bridge import bridge_ratio
from bayesfric.inference.evidence.leave_out import (
    ELPD,
    difference,
    elpd,
    loo_pit,
    refit_without,
    without_each,
)

GROUPS, EACH, DRAWS = 30, 3, 4000


class Case:
    """A linear model whose groups share a deviation, and all of them another.

    Groups are then dependent given the coefficients: only the conditional densities
    are right, not those of each group alone.
    """

    def __init__(self, seed, lever=1.0, misleading=0.0):
        rng = np.random.default_rng(seed)
        size = GROUPS * EACH
        self.of = np.repeat(np.arange(GROUPS), EACH)
        design = np.stack([np.ones(size), rng.uniform(-1, 1, size)], axis=1)
        design[self.of == 0, 1] *= lever
        noise = 0.3 * np.eye(size) + 0.5 * (self.of[:, None] == self.of) + 0.4
        self.model = LinearGaussian(design, np.array([2.0, 2.0]), noise)
        # By Cholesky's factors, of which there is one: those of a decomposition into singular
        # values turn where these are equal, with the library and the processor.
        factor = np.linalg.cholesky(noise)
        self.measured = design @ rng.normal(0, 2.0, 2) + factor @ rng.standard_normal(size)
        self.measured += misleading * design[:, 1] * (self.of == 0)
        mean, covariance = self.model.posterior(self.measured)
        spread = np.linalg.cholesky(covariance)
        self.draws = mean + rng.standard_normal((DRAWS, mean.size)) @ spread.T
        self.residual = self.measured - self.draws @ design.T

    def log_likelihood(self):
        """Of each group given the others and the coefficients."""
        return np.stack([self.conditional(g)[0] for g in range(GROUPS)], axis=1)

    def conditional(self, group):
        """Log density of a group given the rest, and z-score of its first measurement."""
        noise = self.model.noise
        own, rest = self.of == group, self.of != group
        gain = noise[np.ix_(own, rest)] @ np.linalg.inv(noise[np.ix_(rest, rest)])
        covariance = noise[np.ix_(own, own)] - gain @ noise[np.ix_(rest, own)]
        off = self.residual[:, own] - self.residual[:, rest] @ gain.T
        log_density = stats.multivariate_normal(np.zeros(EACH), covariance).logpdf(off)
        return log_density, off[:, 0] / np.sqrt(covariance[0, 0])

    def exact(self, group):
        return self.model.log_conditional(self.measured, self.of == group)

    def exact_pit(self, group):
        """Of the first measurement of a group given all other groups."""
        own, rest = np.flatnonzero(self.of == group)[:1], self.of != group
        covariance = self.model.covariance
        gain = covariance[np.ix_(own, rest)] @ np.linalg.inv(covariance[np.ix_(rest, rest)])
        variance = covariance[np.ix_(own, own)] - gain @ covariance[np.ix_(rest, own)]
        score = (self.measured[own] - gain @ self.measured[rest]) / np.sqrt(variance[0])
        return float(stats.norm.cdf(score[0]))


@pytest.fixture(scope="module")
def case():
    return Case(1)


@pytest.fixture(scope="module")
def loo(case):
    return elpd(case.log_likelihood())


def test_each_group_is_as_in_an_exact_refit(case, loo):
    exact = np.array([case.exact(group) for group in range(GROUPS)])
    assert loo.reliable
    assert loo.pointwise == pytest.approx(exact, abs=0.05)
    assert loo.total == pytest.approx(exact.sum(), abs=0.15)
    assert loo.se == pytest.approx(np.sqrt(GROUPS * exact.var(ddof=1)), rel=0.03)


def test_what_saw_the_data_would_be_too_good(case, loo):
    """Without weights the draws have seen each group; the weights undo that."""
    exact = sum(case.exact(group) for group in range(GROUPS))
    log_likelihood = case.log_likelihood()
    seen = (np.logaddexp.reduce(log_likelihood, axis=0) - np.log(DRAWS)).sum()
    assert abs(loo.total - exact) < 0.2 * (seen - exact)


def test_bad_groups_are_refitted():
    """A group on a long lever decides the slope alone, and its weights fail."""
    case = Case(2, lever=100.0, misleading=0.2)
    log_likelihood = case.log_likelihood()
    smoothed = elpd(log_likelihood)
    asked = []

    def refit(group):
        asked.append(group)
        return case.exact(group)

    mended = elpd(log_likelihood, refit)
    bad = np.flatnonzero(smoothed.pareto_k > smoothed.limit_k).tolist()
    assert 0 in bad
    assert not smoothed.reliable
    assert asked == bad == np.flatnonzero(mended.refitted).tolist()
    assert mended.reliable
    assert mended.pointwise[0] == case.exact(0)
    assert (mended.pointwise[~mended.refitted] == smoothed.pointwise[~mended.refitted]).all()


def test_a_group_that_cannot_be_refitted_stays_unreliable():
    log_likelihood = Case(2, lever=100.0).log_likelihood()
    smoothed, tried = elpd(log_likelihood), elpd(log_likelihood, lambda group: None)
    assert not tried.refitted.any()
    assert not tried.reliable
    assert (tried.pointwise == smoothed.pointwise).all()
    assert tried.bad.tolist() == (smoothed.pareto_k > smoothed.limit_k).tolist()


def test_draws_without_a_group_have_its_exact_posterior():
    """From the density with all data alone, which a group on a long lever decides."""
    case = Case(2, lever=100.0, misleading=0.2)
    posterior = stats.multivariate_normal(*case.model.posterior(case.measured))
    design = case.model.design

    def conditional(points):
        case.residual = case.measured - points @ design.T
        return case.conditional(0)[0]

    def log_density(points):
        return np.atleast_1d(posterior.logpdf(points))

    mode, seen = posterior.mean, posterior.cov
    refit = refit_without(log_density, conditional, mode, np.full(2, 2.0), 1)
    draws = refit.draws
    rest = case.of != 0
    noise = case.model.noise[np.ix_(rest, rest)]
    without = LinearGaussian(design[rest], case.model.prior_sd, noise)
    mean, covariance = without.posterior(case.measured[rest])
    assert abs(mean - mode)[1] > 1.5 * np.sqrt(seen[1, 1])  # all data would mislead
    assert draws.mean(axis=0) == pytest.approx(mean, abs=4 * np.sqrt(covariance.max() / 1000))
    assert np.cov(draws.T) == pytest.approx(covariance, rel=0.15, abs=0.02 * covariance.max())
    value, error = bridge_ratio(conditional(case.draws), conditional(draws))
    assert error < 0.1
    assert abs(value - case.exact(0)) < 3 * error
    # all data have the evidence 1 here: their density is normalised
    assert refit.evidence.error < 0.1
    assert abs(-refit.evidence.log_evidence - case.exact(0)) < 3 * refit.evidence.error


def test_ratio_of_two_normals_and_its_error():
    """Widths of 1 and 2, apart by 1: the log ratio is −log 2, by 60 pairs of draws."""
    rng, off = np.random.default_rng(0), []

    def log_ratio(x):
        return -0.5 * (x - 1) ** 2 + 0.5 * (x / 2) ** 2

    for _ in range(60):
        log_bayes_factor, error = bridge_ratio(
            log_ratio(rng.normal(1, 1, 600)), log_ratio(rng.normal(0, 2, 900))
        )
        off.append((log_bayes_factor + np.log(2)) / error)
    assert abs(np.mean(off)) < 3 / np.sqrt(60)
    assert 0.75 < np.sqrt(np.mean(np.square(off))) < 1.3


def test_densities_that_do_not_overlap_have_an_infinite_error():
    assert bridge_ratio(np.full(100, 2000.0), np.full(100, -2000.0))[1] == np.inf


def test_few_draws_allow_less_of_the_weights(case):
    log_likelihood = case.log_likelihood()
    assert elpd(log_likelihood).limit_k == 0.7
    assert elpd(log_likelihood[:100]).limit_k == pytest.approx(0.5)


def test_groups_no_draw_disagrees_on_are_taken_as_they_are():
    prediction = elpd(np.full((200, 2), -1.25))
    assert prediction.pointwise == pytest.approx(np.full(2, -1.25))
    assert prediction.reliable


def predictions(values, k=0.1):
    values = np.asarray(values, float)
    return ELPD(values, np.full(values.size, k), np.zeros(values.size, bool), 0.7)


def test_difference_is_paired():
    rng = np.random.default_rng(3)
    common, better = rng.normal(0, 50, 40), rng.normal(0.5, 0.2, 40)
    gain = difference(predictions(common + better), predictions(common))
    assert gain.elpd == pytest.approx(better.sum())
    assert gain.se == pytest.approx(np.sqrt(40) * better.std(ddof=1))
    assert gain.reliable
    other = difference(predictions(common), predictions(common + better))
    assert other.elpd == pytest.approx(-gain.elpd)
    assert other.reliable


@pytest.mark.parametrize(
    ("groups", "gain_each", "k", "reasons"),
    [
        (20, 0.21, 0.1, ()),
        (20, 0.19, 0.1, ("less than 4",)),
        (20, -0.19, 0.1, ("less than 4",)),
        (19, 0.5, 0.1, ("fewer than 20",)),
        (20, 0.5, 0.71, ("Pareto k",)),
        (3, 0.5, 0.71, ("fewer than 20", "less than 4", "Pareto k")),
    ],
)
def test_standard_errors_that_are_not_to_be_relied_on(groups, gain_each, k, reasons):
    gain = difference(predictions(np.full(groups, gain_each)), predictions(np.zeros(groups), k))
    assert len(gain.unreliable) == len(reasons)
    assert all(reason in text for reason, text in zip(reasons, gain.unreliable, strict=True))
    assert gain.reliable is (not reasons)


def test_a_single_group_has_no_standard_error():
    assert predictions([1.0]).se == float("inf")
    assert difference(predictions([1.0]), predictions([2.0])).se == float("inf")


def test_pit_is_that_of_exact_refits(case):
    pit = loo_pit(
        np.stack([stats.norm.cdf(case.conditional(g)[1]) for g in range(GROUPS)], axis=1),
        without_each(case.log_likelihood()),
    )
    exact = [case.exact_pit(group) for group in range(GROUPS)]
    assert pit == pytest.approx(exact, abs=0.02)


def test_pit_of_the_right_model_is_uniform_and_of_a_wrong_one_is_not():
    """Each group of ten data sets; wrong: scores as though the noise were half as wide."""
    right, wrong = [], []
    for seed in range(10, 20):
        case = Case(seed)
        scores = np.stack([case.conditional(g)[1] for g in range(GROUPS)], axis=1)
        without = without_each(case.log_likelihood())
        right.append(loo_pit(stats.norm.cdf(scores), without))
        wrong.append(loo_pit(stats.norm.cdf(2 * scores), without))
    assert stats.kstest(np.concatenate(right), "uniform").pvalue > 0.01
    assert stats.kstest(np.concatenate(wrong), "uniform").pvalue < 1e-4


@pytest.mark.parametrize(
    ("log_likelihood", "match"),
    [
        (np.zeros((99, 3)), "at least 100 draws"),
        (np.zeros(200), "shape"),
        (np.full((200, 3), -np.inf), "finite"),
    ],
)
def test_bad_densities_are_refused(log_likelihood, match):
    with pytest.raises(ValueError, match=match):
        elpd(log_likelihood)
    with pytest.raises(ValueError, match=match):
        without_each(log_likelihood)


def test_weights_take_one_array_more_and_what_comes_of_them_none():
    rng = np.random.default_rng(1)
    log_likelihood, cdf = rng.normal(size=(500, 400)), rng.uniform(size=(500, 400))
    tracemalloc.start()
    without = without_each(log_likelihood)
    elpd(log_likelihood, without=without)
    loo_pit(cdf, without)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert log_likelihood.nbytes <= peak < 1.1 * log_likelihood.nbytes


def test_shapes_that_differ_are_refused():
    with pytest.raises(ValueError, match="differ"):
        loo_pit(np.zeros((200, 2)), without_each(np.zeros((200, 3))))
    with pytest.raises(ValueError, match="cannot be paired"):
        difference(predictions([1.0]), predictions([1.0, 2.0]))

"""Trials and assemblies left out: exact refits, and probabilities with a known answer."""

import dataclasses
import tracemalloc
from types import SimpleNamespace

import numpy as np
import pytest
from rigs.hall import gravity_likelihood
from scipy import stats

from bayesfric.analysis import Analysis, HalfNormal, LogNormal, Priors, Sampler
from bayesfric.fitting.hypothesis import chart_of
from bayesfric.fitting.posterior import fit
from bayesfric.fitting.predictive.left_out import (
    by_blocks,
    leave_out,
    leave_setups_out,
    setup_log_densities,
    uniformity,
)
from bayesfric.inference.evidence.importance import importance_draws
from bayesfric.inference.evidence.leave_out import elpd
from bayesfric.inference.laplace import laplace_approximation
from bayesfric.inference.model import Model
from bayesfric.recording.tables import Gravity
from bayesfric.rigs.gravity_board.screening import screen_trials
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import Truth, simulate_recording

# tau and omega all but fixed at the values that recordings are simulated with
KNOWN_SCATTER = Priors(
    tau=LogNormal(median=0.01, sd_log=0.01), omega=LogNormal(median=0.015, sd_log=0.01)
)
# Importance sampling covers the long posterior of a wander that is not there less well.
NO_WANDER = Analysis(priors=Priors(wander=HalfNormal(scale=1e-5)))
DESIGN = Protocol({(9, 85.0): 2, (15, 50.0): 1, (5, 135.0): 1}, (6.0, 28.0), (6.0, 28.0), 2)


def gravity_of(recording, without=()):
    """The trials that enter, but for those of some assemblies."""
    whole = screen_trials(recording.gravity, recording.rig).gravity
    trials = whole.trials[~whole.trials["setup"].isin(without)].reset_index(drop=True)
    events = whole.events[whole.events["trial"].isin(trials["trial"])].reset_index(drop=True)
    return Gravity(trials, events)


def fitted(recording, analysis=None, without=()):
    """A model, its one likelihood, and draws and evidence by importance around the mode."""
    likelihood = gravity_likelihood(
        gravity_of(recording, without), recording.rig, analysis or Analysis()
    )
    model = Model([likelihood])
    laplace = laplace_approximation(model.log_posterior, model.start(), model.scale())
    importance, z = importance_draws(model.log_posterior, laplace, 1, chart_of(model), 6000)
    return model, likelihood, laplace.mode, z, importance


class Named:
    """A model of which only the names are asked."""

    def natural(self, z):
        return z

    def by_name(self, theta):
        return {"x": theta[:, 0]}


def test_blocks_of_draws_join_without_a_second_copy():
    z, columns = np.arange(1050.0)[:, None], np.arange(500.0)
    tracemalloc.start()
    log_likelihood = by_blocks(Named(), lambda theta: theta["x"][:, None] * columns, z)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert (log_likelihood == z * columns).all()
    assert log_likelihood.nbytes <= peak < 1.4 * log_likelihood.nbytes


def test_a_draw_that_is_repeated_is_evaluated_once():
    evaluated = []

    def densities(theta):
        evaluated.extend(theta["x"].tolist())
        return np.stack([theta["x"], 2 * theta["x"]], axis=1)

    model = Named()
    model.likelihoods = [SimpleNamespace(setup_log_likelihood=densities)]
    z = np.array([3.0, 1.0, 3.0, 2.0, 1.0, 3.0])[:, None]
    (by_draw,) = setup_log_densities(model, z)
    assert sorted(evaluated) == [1.0, 2.0, 3.0]
    np.testing.assert_array_equal(by_draw, z * [1.0, 2.0])


@pytest.fixture(scope="module")
def lever():
    """Seven assemblies of one size, of which a single one tells c3."""
    cells = {(9, 85.0): 6, (9, 135.0): 1}
    recording = simulate_recording(
        Protocol(cells, (6.0, 16.0, 28.0), (6.0, 16.0, 28.0), 2), seed=8, rigs=("gravity",)
    )
    trials = recording.gravity.trials
    small = trials["trial"][trials["pulley_size"] == "small"]
    events = recording.gravity.events
    return dataclasses.replace(
        recording,
        gravity=Gravity(
            trials[trials["trial"].isin(small)].reset_index(drop=True),
            events[events["trial"].isin(small)].reset_index(drop=True),
        ),
    )


def test_an_assembly_whose_weights_fail_is_fitted_without(lever):
    """Against the evidences of two models, of which one was never given its trials."""
    model, likelihood, mode, z, _ = fitted(lever, NO_WANDER)
    trials = likelihood.trials
    alone = trials["setup"][trials["wrap_angle_deg"] == 135.0].iloc[0]
    place = likelihood.setups.index(alone)
    left_out = leave_out(model, likelihood, z, mode, 5).setups
    assert left_out.bad[place]
    assert (left_out.refitted == left_out.bad).all()
    assert left_out.reliable
    seen, unseen = fitted(lever, NO_WANDER)[-1], fitted(lever, NO_WANDER, [alone])[-1]
    exact = seen.log_evidence - unseen.log_evidence
    assert left_out.pointwise[place] == pytest.approx(exact, abs=0.15)
    smoothed = elpd(likelihood.setup_log_likelihood(model.by_name(model.natural(z))))
    assert abs(smoothed.pointwise[place] - exact) > 0.5  # which is what the refit is for
    marked = leave_setups_out(setup_log_densities(model, z))
    np.testing.assert_array_equal(marked.bad, left_out.bad)
    assert not marked.refitted.any()
    np.testing.assert_allclose(marked.pointwise, smoothed.pointwise)


def probabilities(seed, factor):
    truth = Truth(tau=0.01 * factor, omega=0.015 * factor)
    recording = simulate_recording(DESIGN, seed=seed, truth=truth, rigs=("gravity",))
    model, likelihood, mode, z, _ = fitted(recording, Analysis(priors=KNOWN_SCATTER))
    left = leave_out(model, likelihood, z[::10], mode, seed)
    return left.pit, uniformity(left.pit, left.again)


@pytest.mark.nightly
def test_recordings_of_the_model_have_uniform_probabilities():
    checks = [probabilities(seed, 1.0) for seed in range(3)]
    together = np.concatenate([pit for pit, _ in checks])
    assert together.size == 3 * 48
    assert stats.kstest(together, "uniform").pvalue > 0.05
    assert min(check.p_value for _, check in checks) > 0.02
    assert np.mean([check.spread for _, check in checks]) == pytest.approx(1, abs=0.1)


@pytest.mark.nightly
def test_twice_the_scatter_does_not():
    """And it is told how much: the density piles up at both ends."""
    pit, check = probabilities(11, 2.0)
    assert check.p_value < 0.002
    assert check.spread == pytest.approx(2, abs=0.3)
    assert check.spread_expected[2] < 1.3
    outside = (check.difference < check.low) | (check.difference > check.high)
    assert outside.any()
    assert check.difference[check.grid < 0.3].max() > 0.05
    assert check.difference[check.grid > 0.7].min() < -0.05
    assert ((pit < 0.05) | (pit > 0.95)).mean() > 0.25


@pytest.mark.nightly
def test_p_values_of_the_right_model_are_uniform():
    checks = [probabilities(seed, 1.0)[1] for seed in range(100, 200)]
    p_values = np.array([check.p_value for check in checks])
    assert stats.kstest(p_values, "uniform").pvalue > 1e-3
    assert stats.binomtest(int((p_values < 0.05).sum()), 100, 0.05).pvalue > 1e-3


def test_the_band_holds_nineteen_in_twenty_recordings_everywhere():
    """Of 60 independent trials, whose shares below have binomial variances."""
    rng = np.random.default_rng(0)
    again = rng.uniform(size=(1500, 60))
    check = uniformity(rng.uniform(size=60), again)
    sd = np.sqrt(check.grid * (1 - check.grid) / 60)
    assert check.high / check.high[24] == pytest.approx(sd / sd[24], rel=0.08)
    assert (check.low == -check.high).all()
    fresh = np.sort(rng.uniform(size=(1000, 60)), axis=1)
    share = (fresh[:, :, None] <= check.grid).mean(axis=1)
    inside = (np.abs(share - check.grid) <= check.high).all(axis=1).mean()
    assert inside == pytest.approx(0.95, abs=0.02)
    ranks = np.sort([uniformity(row, again).p_value for row in fresh[:60]])
    assert stats.kstest(ranks, "uniform").pvalue > 0.01


@pytest.mark.nightly
def test_the_fit_says_that_its_trials_scatter_more_than_it_assumes():
    recording = simulate_recording(DESIGN, seed=11, truth=Truth(tau=0.02, omega=0.03))
    sampler = Sampler(burn=10, steps=80, thin=2, extensions=0)
    summary = fit(recording, Analysis(priors=KNOWN_SCATTER, sampler=sampler)).summary
    (check,) = summary.uniformity
    assert (check.rig, check.trials) == ("gravity", 48)
    assert check.p_value < 0.002
    assert check.spread == pytest.approx(2, abs=0.3)
    (line,) = [line for line in summary.attention if "leave-one-out" in line]
    assert f"{check.spread:.2f} times as far" in line
    assert [(score.left_out, score.groups) for score in summary.prediction] == [
        ("trial", 48),
        ("setup", 12),
    ]

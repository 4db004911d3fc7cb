"""Assemblies left out: against posteriors that never saw them, and one that is made far out."""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from rigs.hall import gravity_likelihood
from scipy import stats

from bayesfric.analysis import Analysis, Sampler
from bayesfric.fitting.hypothesis import chart_of
from bayesfric.fitting.posterior import fit
from bayesfric.fitting.predictive.assemblies import assemblies_of
from bayesfric.fitting.predictive.left_out import LeftOut, coefficients_without, leave_out
from bayesfric.fitting.predictive.reported import assembly_checks
from bayesfric.inference.evidence.importance import importance_draws
from bayesfric.inference.evidence.leave_out import Without
from bayesfric.inference.laplace import laplace_approximation
from bayesfric.inference.model import Model
from bayesfric.physics.friction import Coefficients
from bayesfric.recording.tables import Gravity
from bayesfric.rigs.gravity_board.screening import screen_trials
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import Truth, simulate_recording, table1_coefficients

DESIGN = Protocol({(9, 85.0): 2, (15, 50.0): 1, (5, 135.0): 1}, (6.0, 28.0), (6.0, 28.0), 2)
FAR_BY = 0.09  # of friction: eleven others leave the scatter open, and so how far that is


def one_far(seed, by=FAR_BY):
    """A recording of twelve assemblies, of which one has more friction."""
    more = {
        size: Coefficients(*((1 + by) * value for value in law))
        for size, law in table1_coefficients().items()
    }
    usual, other = (
        simulate_recording(DESIGN, seed=seed, truth=truth, rigs=("gravity",), name="far")
        for truth in (Truth(), Truth(coefficients=more))
    )
    trials, events = usual.gravity.trials, usual.gravity.events
    setup = trials["setup"].iloc[0]
    own = trials["trial"][trials["setup"] == setup]
    swapped = [events[~events["trial"].isin(own)], other.gravity.events.query("trial in @own")]
    order = events.columns.tolist()
    events = type(events)({c: np.concatenate([part[c] for part in swapped]) for c in order})
    events = events.astype(dict(usual.gravity.events.dtypes))
    return dataclasses.replace(usual, gravity=Gravity(trials, events)), setup


def drawn(recording, without=()):
    whole = screen_trials(recording.gravity, recording.rig).gravity
    trials = whole.trials[~whole.trials["setup"].isin(without)].reset_index(drop=True)
    events = whole.events[whole.events["trial"].isin(trials["trial"])].reset_index(drop=True)
    likelihood = gravity_likelihood(Gravity(trials, events), recording.rig, Analysis())
    model = Model([likelihood])
    laplace = laplace_approximation(model.log_posterior, model.start(), model.scale())
    _, z = importance_draws(model.log_posterior, laplace, 1, chart_of(model))
    return model, likelihood, laplace.mode, z


@pytest.mark.nightly
def test_a_probability_is_that_of_a_posterior_that_never_saw_the_assembly():
    recording, setup = one_far(3)
    model, likelihood, mode, z = drawn(recording)
    left = leave_out(model, likelihood, z[::4], mode, 5)
    unseen, _, _, others = drawn(recording, without=[setup])
    named = unseen.by_name(unseen.natural(others[::4]))
    place = likelihood.setups.index(setup)
    exact = likelihood.given_rest(named).setup_cdf[:, place].mean()
    assert stats.norm.isf(left.setup_pit[place]) == pytest.approx(stats.norm.isf(exact), abs=0.3)
    assert stats.norm.isf(exact) < -2.5
    for name, means in left.without.items():
        error = named[name].std() / np.sqrt(100)  # of few draws, that carry most of the weight
        assert abs(means[place] - named[name].mean()) < 4 * error, name
    rest = np.delete(left.setup_pit, place)
    assert stats.kstest(rest, "uniform").pvalue > 0.01


@pytest.mark.parametrize("far", [3.3, -3.3])
def test_an_assembly_at_3_3_sd_is_named(far):
    pit = stats.norm.cdf(np.append(stats.norm.ppf((np.arange(29) + 0.5) / 29), far))
    assemblies = assemblies_of(_left(pit), tuple(f"s{place:03d}" for place in range(30)), 1)
    z = dict(zip(assemblies.names, assemblies.z, strict=True))
    assert z["s029"] == pytest.approx(far)
    # One of thirty beyond 3.3: 30 times 9.67e-4, less what is counted twice.
    assert assemblies.chance(far) == pytest.approx(1 - (1 - 9.67e-4) ** 30, rel=1e-3)
    assert assemblies.uniformity.p_value > 0.1  # the distribution of all says nothing of one


def _left(pit, without=()):
    empty = np.empty((0, 0))
    return LeftOut(empty, empty, None, None, np.empty(0), empty, pit, empty, dict(without))


def test_coefficients_without_a_group_are_weighted_means_or_those_of_its_refit():
    """Of draws 1, 2, 3: even weights leave 2, weights ¼, 0, ¾ make 2.5, and a refit counts."""
    kinds = (
        SimpleNamespace(name="tau", kind="scatter"),
        SimpleNamespace(name="c1", kind="coefficient"),
    )
    model = SimpleNamespace(parameters=kinds, natural=lambda z: 10 * z)
    z = np.array([[7.0, 0.1], [7.0, 0.2], [7.0, 0.3]])
    weights = np.array([[1 / 3, 0.25, 1 / 3], [1 / 3, 1e-300, 1 / 3], [1 / 3, 0.75, 1 / 3]])
    without = Without(np.log(weights), np.zeros(3))
    means = coefficients_without(model, z, without, {2: np.array([[0.0, 0.5], [0.0, 0.7]])})
    assert list(means) == ["c1"]
    assert means["c1"] == pytest.approx([2.0, 2.5, 6.0])


def test_a_far_assembly_carries_the_coefficients_without_it():
    pit = stats.norm.cdf([0.0, -0.5, np.nan, 0.5, 3.4, 1.0])
    left = _left(pit, {"c1[small]": np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])})
    checks = assembly_checks({"gravity": assemblies_of(left, tuple("abcdef"), 1)})
    (far,) = checks[0].outlying
    assert (far.setup, far.without) == ("e", {"c1[small]": 5.0})


def test_fewer_than_five_have_no_distribution():
    pit = np.array([0.2, np.nan, 0.5, 0.8, 0.4])
    assert assemblies_of(_left(pit), tuple("abcde"), 1) is None


def test_scores_stand_beside_those_of_their_rank():
    """Of five independent ones the middle is that of Beta(3, 3): none, with 90 % ± 0.88."""
    pit = np.array([0.9, 0.1, 0.3, 0.5, 0.7])
    assemblies = assemblies_of(_left(pit), tuple("abcde"), 1)
    trials = pd.DataFrame({"setup": list("aabcde"), "n_pulleys": [9, 9, 5, 5, 5, 5]})
    table = assemblies.table(trials)
    assert table["assembly"].to_numpy().tolist() == list("bcdea")
    assert table["trials"].to_numpy().tolist() == [1, 1, 1, 1, 2]
    assert table["n_pulleys"].to_numpy().tolist() == [5, 5, 5, 5, 9]
    low, middle, high = table["expected"].to_numpy()[2]
    assert middle == pytest.approx(0.0, abs=1e-9)
    assert high == pytest.approx(stats.norm.ppf(stats.beta(3, 3).ppf(0.95)))
    assert low == pytest.approx(-high)


@pytest.mark.nightly
def test_the_fit_names_it():
    recording, setup = one_far(3, by=0.2)
    sampler = Sampler(burn=10, steps=80, thin=2, extensions=0)
    summary = fit(recording, Analysis(seed=2, sampler=sampler)).summary
    (check,) = summary.assemblies
    assert [assembly.setup for assembly in check.outlying] == [setup]
    assert check.outlying[0].z > 3
    assert any(
        f"Friction of assembly {setup} of the gravity board is" in s for s in summary.attention
    )


def test_scores_of_trials_are_those_of_their_probabilities_over_what_is_expected(small_fit):
    """Of the fit's own trials: sorted, inside the band as often as it says, and by SciPy."""
    trials, checks = small_fit.predictive["trials"], small_fit.predictive["trial_checks"]
    expected = np.sort(stats.norm.ppf(trials["loo_pit"].to_numpy()))
    assert checks["score"].to_numpy() == pytest.approx(expected)
    low, middle, high = checks["score_expected"].to_numpy().T
    blom = stats.norm.ppf((np.arange(1, middle.size + 1) - 0.375) / (middle.size + 0.25))
    assert middle == pytest.approx(blom, abs=0.15)  # the medians of a normal sample's order
    assert (low < middle).all()
    assert (middle < high).all()

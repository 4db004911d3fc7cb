"""What the trials that were left out would change: a second fit, or why there is none."""

import dataclasses

import numpy as np
import pytest
from altered import of_size, one_size, with_trials

import bayesfric as bf
from bayesfric.analysis import Analysis, Sampler
from bayesfric.recording.tables import Gravity
from bayesfric.rigs.gravity_board import trials
from bayesfric.rigs.gravity_board.screening import screen_trials

SHORT = Analysis(seed=5, sampler=Sampler(burn=10, steps=80, thin=2, extensions=0))


def with_fast_clock(recording, trials, factor):
    """Trials whose load sensor counts its time too fast: less friction than there was."""
    gravity = recording.gravity
    events = gravity.events.copy()
    rows = events["trial"].isin(trials) & (events["sensor"] == "load")
    first = events[rows].groupby("trial")["time_s"].transform("first")
    events.loc[rows, "time_s"] = first + (events.loc[rows, "time_s"] - first) / factor
    return dataclasses.replace(recording, gravity=Gravity(gravity.trials, events))


@pytest.fixture(scope="module")
def two_sizes(small_recording):
    return with_trials(small_recording, ~of_size(small_recording, "large"))


@pytest.fixture(scope="module")
def medium(small_recording):
    return with_trials(small_recording, of_size(small_recording, "medium"))


@pytest.fixture(scope="module")
def odd(medium):
    return medium.gravity.trials["trial"][::2]


@pytest.fixture(scope="module")
def spoilt(two_sizes, odd):
    return with_fast_clock(two_sizes, odd, 1.03)


@pytest.fixture(scope="module")
def summary(spoilt):
    return bf.fit(spoilt, SHORT).summary


def test_trials_that_disagree_lower_the_friction_of_their_size(summary, spoilt, odd):
    """One sensor of two in half of a size's trials: a quarter of what the sensors differ by."""
    assert {entry.trial for entry in summary.data_quality.excluded} == set(odd)
    without = summary.without_exclusions
    assert summary.without_exclusions_why is None
    assert (summary.data_quality.trials_used, without.trials_used) == (24, 32)
    assert list(without.pulleys) == list(summary.pulleys)
    agreement = screen_trials(spoilt.gravity, spoilt.rig).agreement.trials.set_index("trial")
    share = agreement.loc[odd, "friction_share"].astype(float)
    moved = {
        size: (16 * without.pulleys[size]["c1"].mean + without.pulleys[size]["c2"].mean)
        / (16 * laws["c1"].mean + laws["c2"].mean)
        - 1
        for size, laws in summary.pulleys.items()
    }
    assert -share.max() / 4 < moved.pop("medium") < -share.min() / 4
    assert all(abs(shift) < share.min() / 4 for shift in moved.values())


@pytest.mark.nightly
def test_a_gross_fault_is_noise_that_no_prior_expected(medium):
    """Event errors of centimetres, hundreds of prior scales, can still be computed."""
    trial = medium.gravity.trials["trial"][2]
    summary = bf.fit(with_fast_clock(medium, [trial], 1.2), SHORT).summary
    assert [entry.trial for entry in summary.data_quality.excluded] == [trial]
    for size, laws in summary.without_exclusions.pulleys.items():
        assert laws["c1"].sd > 1.2 * summary.pulleys[size]["c1"].sd


@pytest.mark.nightly
def test_it_is_the_fit_of_the_recording_that_has_no_rules(spoilt, summary, monkeypatch):
    """Number by number what the one code path gives where nothing is left out."""
    screen = trials.screen_trials
    monkeypatch.setattr(
        trials, "screen_trials", lambda gravity, rig, **_: screen(gravity, rig, exclude=False)
    )
    plain = bf.fit(spoilt, SHORT).summary
    assert plain.without_exclusions is None
    for name, laws in summary.without_exclusions.pulleys.items():
        for c, interval in laws.items():
            entry = plain.pulleys[name][c].model_dump(include={"mean", "sd", "q05", "q50", "q95"})
            assert interval.model_dump() == entry
    assert summary.without_exclusions.converged == plain.converged


@pytest.mark.nightly
def test_the_trials_change_nothing_in_the_fit_without_them(summary, spoilt, odd):
    gravity = spoilt.gravity
    trials = gravity.trials[~gravity.trials["trial"].isin(odd)].reset_index(drop=True)
    events = gravity.events[~gravity.events["trial"].isin(odd)].reset_index(drop=True)
    clean = bf.fit(dataclasses.replace(spoilt, gravity=Gravity(trials, events)), SHORT).summary
    assert clean.pulleys == summary.pulleys
    assert clean.without_exclusions is None
    assert clean.without_exclusions_why == "no trial was left out"


def test_a_trial_that_cannot_be_computed_enters_neither(medium):
    gravity = medium.gravity
    events = gravity.events.copy()
    rows = (events["trial"] == gravity.trials["trial"][2]).to_numpy()
    events.loc[rows, "time_s"] = np.sort(np.random.default_rng(2).uniform(0.5, 2.0, rows.sum()))
    summary = bf.fit(
        dataclasses.replace(medium, gravity=Gravity(gravity.trials, events)), SHORT
    ).summary
    assert [entry.rule for entry in summary.data_quality.excluded] == ["unrepairable-events"]
    assert summary.without_exclusions is None
    assert "can be computed" in summary.without_exclusions_why


@pytest.mark.nightly
def test_the_motor_board_has_no_rules(small_recording):
    summary = bf.fit(one_size(small_recording, "medium"), SHORT, rigs=("motor",)).summary
    assert summary.without_exclusions is None
    assert "no rule" in summary.without_exclusions_why

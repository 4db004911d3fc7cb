"""What the trials that were left out would change: a second fit, or why there is none."""

import dataclasses

import numpy as np
import pytest

import bayesfric as bf
from bayesfric.analysis import Analysis, Sampler
from bayesfric.recording.tables import Gravity

SHORT = Analysis(seed=5, sampler=Sampler(burn=60, steps=80, thin=2, extensions=0))
TRIAL = "g0007"


@pytest.fixture(scope="module")
def size(small_recording):
    trials = small_recording.gravity.trials.set_index("trial")
    return trials.loc[TRIAL, "pulley_size"]


@pytest.fixture(scope="module")
def spoilt(small_recording):
    """One trial whose load sensor's clock runs 20 % fast: far off in its friction."""
    gravity = small_recording.gravity
    events = gravity.events.copy()
    rows = (events["trial"] == TRIAL) & (events["sensor"] == "load")
    first = events.loc[rows, "time_s"].iloc[0]
    events.loc[rows, "time_s"] = first + (events.loc[rows, "time_s"] - first) / 1.2
    return dataclasses.replace(small_recording, gravity=Gravity(gravity.trials, events))


@pytest.fixture(scope="module")
def found(spoilt):
    return bf.fit(spoilt, SHORT).summary


def test_a_trial_that_disagrees_moves_its_size(found, size):
    assert [entry.trial for entry in found.data_quality.excluded] == [TRIAL]
    without = found.without_exclusions
    assert found.without_exclusions_why is None
    assert (found.data_quality.trials_used, without.trials_used) == (47, 48)
    assert list(without.pulleys) == list(found.pulleys)
    moved = {
        name: max(abs(without.pulleys[name][c].mean - entry.mean) / entry.sd for c, entry in laws)
        for name, laws in ((name, laws.items()) for name, laws in found.pulleys.items())
    }
    # One trial of its size's 16 moves them by more than they were thought to be known.
    assert moved[size] == max(moved.values())
    assert moved[size] > 1
    # Scatter that must hold the odd trial widens every size.
    for name, laws in found.pulleys.items():
        assert without.pulleys[name]["c1"].sd > 1.5 * laws["c1"].sd


def test_it_is_the_fit_of_the_recording_that_has_no_rules(spoilt, found, monkeypatch):
    """Number by number what the one code path gives where nothing is left out."""
    from bayesfric import fitting

    screen = fitting.screen_trials
    monkeypatch.setattr(
        fitting, "screen_trials", lambda gravity, rig, **_: screen(gravity, rig, exclude=False)
    )
    plain = bf.fit(spoilt, SHORT).summary
    assert plain.without_exclusions is None
    for name, laws in found.without_exclusions.pulleys.items():
        for c, interval in laws.items():
            entry = plain.pulleys[name][c].model_dump(include={"mean", "sd", "q05", "q50", "q95"})
            assert interval.model_dump() == entry
    assert found.without_exclusions.converged == plain.converged


def test_the_trial_changes_nothing_in_the_fit_without_it(found, spoilt):
    gravity = spoilt.gravity
    trials = gravity.trials[gravity.trials["trial"] != TRIAL].reset_index(drop=True)
    events = gravity.events[gravity.events["trial"] != TRIAL].reset_index(drop=True)
    clean = bf.fit(dataclasses.replace(spoilt, gravity=Gravity(trials, events)), SHORT).summary
    assert clean.pulleys == found.pulleys
    assert clean.without_exclusions is None
    assert clean.without_exclusions_why == "no trial was left out"


def test_a_trial_that_cannot_be_computed_enters_neither(small_recording):
    gravity = small_recording.gravity
    events = gravity.events.copy()
    rows = (events["trial"] == TRIAL).to_numpy()
    events.loc[rows, "time_s"] = np.sort(np.random.default_rng(2).uniform(0.5, 2.0, rows.sum()))
    summary = bf.fit(
        dataclasses.replace(small_recording, gravity=Gravity(gravity.trials, events)), SHORT
    ).summary
    assert [entry.rule for entry in summary.data_quality.excluded] == ["unrepairable-events"]
    assert summary.without_exclusions is None
    assert "can be computed" in summary.without_exclusions_why


def test_the_motor_board_has_no_rules(small_recording):
    summary = bf.fit(small_recording, SHORT, rigs=("motor",)).summary
    assert summary.without_exclusions is None
    assert "gravity board" in summary.without_exclusions_why

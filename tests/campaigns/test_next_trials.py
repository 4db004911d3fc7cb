"""What a diagnosis proposes as the next trial tells apart what it was to tell apart."""

import pytest
from campaigns import evidence, next_trials

from bayesfric.campaign import run_on_processes

CORNER = {
    "rig": "gravity",
    "pulley_size": "medium",
    "n_pulleys": 15.0,
    "wrap_angle_deg": 135.0,
    "mass_drive_kg": 3.5,
    "mass_load_kg": 2.2,
}


def test_a_further_trial_is_one_more_on_an_assembly_of_its_own():
    design = next_trials.DESIGNS["few-at-wide"]
    board = next_trials.simulate_recording(design, seed=1, rigs=("gravity",))
    gravity = next_trials.with_trial(board, CORNER, next_trials.Truth(), 1).gravity
    assert len(gravity.trials) == len(board.gravity.trials) + 1
    last = gravity.trials.iloc[-1]
    assert {name: last[name] for name in CORNER if name != "rig"} == {
        name: value for name, value in CORNER.items() if name != "rig"
    }
    assert (gravity.trials["setup"] == "next").sum() == 1
    assert last["order"] == gravity.trials["order"].max()
    seen = gravity.events[gravity.events["trial"] == "next"]
    assert set(seen["sensor"]) == {"drive", "load"}
    assert gravity.events.iloc[: len(board.gravity.events)].equals(board.gravity.events)


def test_figures_by_hand():
    """Of three that were open two end beyond odds of 20, one of them against what acts."""
    record = {"effect": "a", "separates": ["a", "b"], "expected": 2.0, "before": 0.0}
    done = [record | {"after": 1.5}, record | {"after": -2.0}, record | {"after": 1.0}]
    figures = next_trials.figures([*done, {"effect": "a", "separates": None}])
    assert (figures["boards"], figures["open"]) == (4, 3)
    assert (figures["told_apart"]["count"], figures["told_apart"]["of"]) == (2, 3)
    right = figures["of_these_in_favour_of_what_acts"]
    assert (right["count"], right["of"]) == (1, 2)
    assert figures["median_realised"] == 1.5


def test_where_nothing_was_open_there_is_no_share():
    figures = next_trials.figures([{"effect": "a", "separates": None}])
    assert figures == {"boards": 1, "open": 0}


def test_where_no_pair_had_what_acts_there_is_no_share_in_its_favour():
    record = {"effect": "a", "separates": ["b", "c"], "expected": 2.0, "before": 0.0, "after": 2.0}
    assert next_trials.figures([record])["of_these_in_favour_of_what_acts"] == {"count": 0, "of": 0}


def run(cases, folder):
    return list(run_on_processes(next_trials.case, cases, folder, workers=2).values())


@pytest.mark.nightly
def test_the_first_boards_are_those_of_the_evidence(tmp_path):
    recorded = {record["seed"]: record for record in evidence.read("next_trials")["fixed"]}
    for now in run(dict(list(next_trials.cases().items())[: next_trials.FIXED]), tmp_path):
        then = recorded[now["seed"]]
        assert (now["verdict"], now["separates"]) == (then["verdict"], then["separates"])

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
    found = next_trials.with_trial(board, CORNER, next_trials.Truth(), 1).gravity
    assert len(found.trials) == len(board.gravity.trials) + 1
    last = found.trials.iloc[-1]
    assert {name: last[name] for name in CORNER if name != "rig"} == {
        name: value for name, value in CORNER.items() if name != "rig"
    }
    assert (found.trials["setup"] == "next").sum() == 1
    assert last["order"] == found.trials["order"].max()
    seen = found.events[found.events["trial"] == "next"]
    assert set(seen["sensor"]) == {"drive", "load"}
    assert found.events.iloc[: len(board.gravity.events)].equals(board.gravity.events)


def test_figures_by_hand():
    """Of three that were open two end beyond odds of 20, one of them against what acts."""
    one = {"effect": "a", "separates": ["a", "b"], "expected": 2.0, "before": 0.0}
    done = [one | {"after": 1.5}, one | {"after": -2.0}, one | {"after": 1.0}]
    found = next_trials.figures([*done, {"effect": "a", "separates": None}])
    assert (found["boards"], found["open"]) == (4, 3)
    assert (found["told_apart"]["count"], found["told_apart"]["of"]) == (2, 3)
    right = found["of_these_in_favour_of_what_acts"]
    assert (right["count"], right["of"]) == (1, 2)
    assert found["median_realised"] == 1.5


def test_where_nothing_was_open_there_is_no_share():
    found = next_trials.figures([{"effect": "a", "separates": None}])
    assert found == {"boards": 1, "open": 0}


def test_where_no_pair_had_what_acts_there_is_no_share_in_its_favour():
    one = {"effect": "a", "separates": ["b", "c"], "expected": 2.0, "before": 0.0, "after": 2.0}
    assert next_trials.figures([one])["of_these_in_favour_of_what_acts"] == {"count": 0, "of": 0}


def run(cases, folder):
    return list(run_on_processes(next_trials.case, cases, folder, workers=2).values())


@pytest.mark.nightly
def test_the_first_boards_are_those_of_the_evidence(tmp_path):
    recorded = {one["seed"]: one for one in evidence.read("next_trials")["fixed"]}
    for now in run(dict(list(next_trials.cases().items())[: next_trials.FIXED]), tmp_path):
        then = recorded[now["seed"]]
        assert (now["verdict"], now["separates"]) == (then["verdict"], then["separates"])

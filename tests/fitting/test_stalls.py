"""Trials that did not move in a fit: more friction than without them, and both stand in it."""

import pytest
from altered import of_size, with_trials

import bayesfric as bf
from bayesfric.analysis import Analysis, Sampler
from bayesfric.physics.friction import Coefficients
from bayesfric.simulate import Truth, simulate_recording, table1_coefficients

SHORT = Analysis(seed=5, sampler=Sampler(burn=10, steps=80, thin=2, extensions=0))


@pytest.fixture(scope="module")
def recording():
    """Medium pulleys with half as much friction again as the masses were chosen for."""
    heavy = {
        size: Coefficients(*(1.6 * value for value in law))
        for size, law in table1_coefficients().items()
    }
    truth = Truth(coefficients=heavy, tau=0.04, omega=0.02)
    whole = simulate_recording("quick", seed=4, truth=truth, rigs=("gravity",))
    return with_trials(whole, of_size(whole, "medium"))


@pytest.mark.nightly
def test_stalls_raise_friction_and_are_shown_beside_the_fit_without_them(recording):
    trials = recording.gravity.trials
    still = trials["trial"][trials["did_not_move"] == "true"]
    assert len(still) >= 10
    summary = bf.fit(recording, SHORT).summary
    assert summary.data_quality.did_not_move == tuple(still)
    assert summary.data_quality.trials_used == len(trials)
    assert summary.without_stalls.trials_used == len(trials) - len(still)

    def friction(laws):
        return 16 * laws["c1"].mean + laws["c2"].mean

    own, other = summary.pulleys["medium"], summary.without_stalls.pulleys["medium"]
    # Half of the trials at the threshold are gone, and the rest scatter by 4 %.
    assert 1.002 < friction(own) / friction(other) < 1.05


def test_where_all_moved_there_is_a_reason_in_its_place(small_recording):
    summary = bf.fit(
        with_trials(small_recording, of_size(small_recording, "medium")), SHORT
    ).summary
    assert summary.without_stalls is None
    assert "moved to the end, or none did" in summary.without_stalls_why

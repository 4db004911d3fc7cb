"""A diagnosis that is interrupted goes on: nothing is weighed twice, and the result is the same."""

from collections import Counter
from dataclasses import replace

import pytest
from altered import by_acceleration, of_size, with_trials
from rigs.friction_points import curved, recorded

from bayesfric import checkpoint
from bayesfric.analysis import Analysis
from bayesfric.diagnosis import compared, diagnose, diagnosing, measured
from bayesfric.results import json_bytes
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import simulate_recording

LONG = {
    "climb": compared,
    "weigh": compared,
    "unknown_force": compared,
    "measure_gap": measured,
    "block_densities": measured,
    "where_it_lies": diagnosing,
}
"""What takes long, and what comes after it."""


@pytest.fixture(scope="module")
def recording():
    """Of one size with an effect, so that finalists are compared."""
    design = Protocol({(9, 85.0): 2, (15, 50.0): 1}, (6.0, 28.0), (6.0, 28.0), 2)
    board = simulate_recording(design, seed=21, effects={"viscous": 1.0}, rigs=("gravity",))
    return by_acceleration(with_trials(board, of_size(board, "small")))


class Counted:
    """Calls that came to their end, and where the next one is interrupted."""

    def __init__(self, monkeypatch):
        self.done, self.stop = Counter(), (None, 0)
        for name, module in LONG.items():
            monkeypatch.setattr(module, name, self.counting(name, getattr(module, name)))

    def counting(self, name, function):
        def counted(*arguments, **options):
            if (name, self.done[name]) == self.stop:
                raise KeyboardInterrupt
            value = function(*arguments, **options)
            self.done[name] += 1
            return value

        return counted


@pytest.fixture
def counted(monkeypatch):
    return Counted(monkeypatch)


@pytest.fixture(params=["points", pytest.param("board", marks=pytest.mark.nightly)])
def either(request, tmp_path):
    """The board; and points, of which all steps are the same in less time."""
    if request.param == "board":
        return request.getfixturevalue("recording")
    return recorded(tmp_path / "bench", curved(2))


def start(recording, folder, counted, stop):
    counted.stop = stop
    with pytest.raises(KeyboardInterrupt):
        diagnose(recording, Analysis(seed=3), checkpoint=folder)
    counted.stop = (None, 0)


def test_nothing_is_weighed_twice_and_the_bytes_are_the_same(either, counted, tmp_path):
    """Interrupted in the fit of the baseline, among hypotheses and finalists, and in the folds."""
    uninterrupted = diagnose(either, Analysis(seed=3))  # at one go, with nothing kept
    calls = counted.done.copy()
    counted.done.clear()
    assert calls["climb"] == 3
    assert calls["weigh"] > 10
    assert calls["unknown_force"] > 1  # once of the first look, again of the finalists
    for place in [("climb", 1), ("weigh", calls["weigh"] - 1), ("where_it_lies", 0)]:
        start(either, tmp_path / "c", counted, place)
        assert len(list((tmp_path / "c").glob("*.npz"))) == counted.done.total()
    again = diagnose(either, Analysis(seed=3), checkpoint=tmp_path / "c")
    assert counted.done == calls
    assert json_bytes(again.summary) == json_bytes(uninterrupted.summary)
    assert again.curves.identical(uninterrupted.curves)


def other_settings(recording):
    return {"recording": recording, "analysis": Analysis(seed=4)}


def other_data(recording):
    return {"recording": replace(recording, sha256="0" * 64)}


def other_gravity(recording):
    rig = replace(recording.rig, gravity_m_s2=9.81)
    return {"recording": replace(recording, rig=rig)}


def other_law(recording):
    return {"recording": recording, "fixed": ["c3"]}


@pytest.mark.nightly
@pytest.mark.parametrize("change", [other_settings, other_data, other_gravity, other_law])
def test_pieces_of_other_inputs_are_dropped(recording, counted, tmp_path, change):
    start(recording, tmp_path / "c", counted, ("climb", 2))
    counted.stop = ("climb", 3)
    given = {"analysis": Analysis(seed=3), "checkpoint": tmp_path / "c", **change(recording)}
    with pytest.raises(KeyboardInterrupt):
        diagnose(**given)
    assert {path.stem for path in (tmp_path / "c").glob("*.npz")} == {"climb-0000"}
    assert counted.done == {"climb": 3}


def test_pieces_of_other_code_are_dropped(recording, counted, tmp_path, monkeypatch):
    start(recording, tmp_path / "c", counted, ("climb", 2))
    monkeypatch.setattr(checkpoint, "code_sha256", lambda: "other")
    start(recording, tmp_path / "c", counted, ("climb", 3))
    assert counted.done == {"climb": 3}


def test_with_an_effect_of_the_users_own_nothing_is_kept(recording, counted, tmp_path):
    """Its code may have changed, which cannot be told."""
    from bayesfric.effects import all_effects

    counted.stop = ("climb", 2)
    with pytest.raises(KeyboardInterrupt):
        diagnose(
            recording,
            Analysis(seed=3),
            effects=[all_effects()["viscous"]],
            checkpoint=tmp_path / "c",
        )
    assert not (tmp_path / "c").exists()


@pytest.mark.nightly
def test_a_resumed_diagnosis_has_the_shapes_of_the_whole_one(counted, tmp_path):
    """What hypotheses had asked of the data rounded what was asked of them for the draws."""
    recording = simulate_recording("quick", seed=11, effects={"stribeck": 1.0}, rigs=("motor",))
    whole = diagnose(recording, Analysis(seed=3))
    counted.done.clear()
    start(recording, tmp_path / "c", counted, ("where_it_lies", 0))
    resumed = diagnose(recording, Analysis(seed=3), checkpoint=tmp_path / "c")
    assert json_bytes(resumed.summary) == json_bytes(whole.summary)

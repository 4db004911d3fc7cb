"""Claims that are interrupted go on: no study is done twice, and the result is the same."""

from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import pytest
from altered import by_acceleration, of_size, with_trials

from bayesfric import checkpoint
from bayesfric.analysis import Analysis
from bayesfric.claims import check_claims, studies
from bayesfric.results import json_bytes

ONLY = ("no-stribeck",)
SEED = Analysis(seed=3)


@pytest.fixture(scope="module")
def recording(small_recording):
    """One size on the gravity board, by accelerations: studies of seconds."""
    return by_acceleration(with_trials(small_recording, of_size(small_recording, "small")))


@pytest.fixture(scope="module")
def whole(recording):
    """At one go, with nothing kept."""
    return check_claims(recording, SEED, only=ONLY)


@pytest.fixture
def studied(monkeypatch):
    """How often each hypothesis is studied."""
    counts, study = Counter(), studies._study_one

    def counted(given):
        counts[studies._name(given)] += 1
        return study(given)

    monkeypatch.setattr(studies, "_study_one", counted)
    return counts


def interrupted_after(pieces):
    def progress(done, total):
        if done == pieces:
            raise KeyboardInterrupt

    return progress


def judge(recording, folder, analysis=SEED, **options):
    return check_claims(recording, analysis, only=ONLY, checkpoint=folder, **options)


def start(recording, folder, pieces):
    with pytest.raises(KeyboardInterrupt):
        judge(recording, folder, progress=interrupted_after(pieces))


def pieces_of(folder):
    return {path.stem for path in folder.glob("*.npz")}


@pytest.mark.parametrize("threads", [False, True])
def test_no_study_is_done_twice_and_the_bytes_are_the_same(
    recording, whole, studied, tmp_path, threads
):
    start(recording, tmp_path / "c", 3)
    assert pieces_of(tmp_path / "c") == set(studied)
    assert len(studied) == 3
    progressed = []

    def progress(done, total):
        progressed.append((done, total))

    with ThreadPoolExecutor(1) as pool:
        executor = pool if threads else None
        resumed = judge(recording, tmp_path / "c", executor=executor, progress=progress)
    assert set(studied.values()) == {1}
    assert pieces_of(tmp_path / "c") == set(studied)
    assert [done for done, _ in progressed] == list(range(1, len(studied) + 1))
    assert all(done <= total for done, total in progressed)
    assert json_bytes(resumed.summary) == json_bytes(whole.summary)
    assert resumed.curves.identical(whole.curves)


def other_settings(recording):
    return recording, Analysis(seed=4)


def other_data(recording):
    return replace(recording, sha256="0" * 64), SEED


def other_gravity(recording):
    return replace(recording, rig=replace(recording.rig, gravity_m_s2=9.81)), SEED


@pytest.mark.parametrize("change", [other_settings, other_data, other_gravity])
def test_pieces_of_other_inputs_are_dropped(recording, studied, tmp_path, change):
    start(recording, tmp_path / "c", 2)
    first = dict(studied)
    recording, analysis = change(recording)
    with pytest.raises(KeyboardInterrupt):
        judge(recording, tmp_path / "c", analysis, progress=interrupted_after(1))
    again = [name for name in first if studied[name] == 2]
    assert len(again) == 1
    assert pieces_of(tmp_path / "c") == set(again)


def test_pieces_of_other_code_are_dropped(recording, studied, tmp_path, monkeypatch):
    start(recording, tmp_path / "c", 2)
    monkeypatch.setattr(checkpoint, "code_sha256", lambda: "other")
    start(recording, tmp_path / "c", 1)
    assert sorted(studied.values()) == [1, 2]

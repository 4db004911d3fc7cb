"""Twenty kills and ten interrupts at random places lose nothing, and mix nothing.

Seeds, and so the moments as shares of an undisturbed run, were fixed before the first run.
"""

import pytest
from campaigns import kills

NIGHTLY = 2


def assert_whole(case):
    assert case["same_bytes"], case
    if "status" not in case:
        assert case["state"] != "mixed", case
        return
    assert case["status"] in (0, 3), case
    assert case["status"] == 0 or case["ended_after_s"] <= kills.PROMPT_S, case
    assert not case["traceback"], case
    assert case["twice"] == [], case


@pytest.mark.parametrize(
    "fault",
    [
        {"status": 70},
        {"ended_after_s": 2.5},
        {"traceback": True},
        {"twice": ["fit"]},
        {"same_bytes": False},
    ],
)
def test_each_fault_of_an_interrupt_is_told(fault):
    fine = {
        "status": 3,
        "ended_after_s": 1.5,
        "traceback": False,
        "twice": [],
        "same_bytes": True,
    }
    assert_whole(fine)
    with pytest.raises(AssertionError):
        assert_whole(fine | fault)


def test_results_of_two_runs_are_told_from_those_of_one(tmp_path, monkeypatch):
    """Two sets of files: whole ones are old or new, and one of each is mixed."""
    for name in ("old", "new", "here"):
        (tmp_path / name).mkdir()
    for name in ("old", "new"):
        for file in ("claims.json", "claims.nc", "diagnosis.json", "diagnosis.nc"):
            (tmp_path / name / file).write_text(f"{name} {file}")
    monkeypatch.setattr(kills, "read_stored", lambda folder: None)
    bench = kills.Bench.__new__(kills.Bench)
    bench.folder = tmp_path
    bench.wanted = {"run": kills.digests(tmp_path / "new"), "blind": {}}

    def put(**sources):
        for file, source in sources.items():
            name = file.replace("_", ".")
            (tmp_path / "here" / name).write_text(f"{source} {name}")
        return bench.state(tmp_path / "here")

    assert put() == ""
    assert put(claims_json="old", claims_nc="old") == "old"
    assert put(diagnosis_json="new", diagnosis_nc="new") == "new+old"
    assert put(claims_json="new") == "mixed"
    assert put(claims_nc="new") == "new"


@pytest.mark.nightly
def test_some_kills_lose_nothing(tmp_path):
    bench = kills.Bench(tmp_path)
    for seed in kills.SEEDS["run"][:NIGHTLY]:
        assert_whole(kills.killed(bench, "run", seed))
    for seed in kills.SEEDS["interrupted"][:NIGHTLY]:
        assert_whole(kills.interrupted(bench, seed))

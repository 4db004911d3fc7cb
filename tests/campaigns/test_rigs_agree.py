"""Boards that agree are said to, those 12 % apart are not; Table I where it is informed.

Seeds and bounds were fixed before the first run.
"""

import pytest
from campaigns import evidence, rigs_agree

from bayesfric.campaign import run_on_processes

NIGHTLY = {"true": range(42_000, 42_002), "apart": range(42_100, 42_102)}


def run(cases, folder):
    return list(run_on_processes(rigs_agree.case, cases, folder, workers=2).values())


def count(figures, kind, claim, verdict):
    return figures[f"{kind}: {claim}"].get(verdict, {"count": 0})["count"]


def test_verdicts_are_counted_by_kind_and_claim():
    """Of ten recordings two: 2.5 to 55.6 %, by the tables of Clopper and Pearson."""
    verdicts = ["supported"] * 2 + ["undecided"] * 8
    done = [
        {"kind": kind, "verdicts": dict.fromkeys(rigs_agree.CLAIMS, verdict)}
        for kind in rigs_agree.KINDS
        for verdict in verdicts
    ]
    found = rigs_agree.figures(done)["apart: rigs-agree"]
    assert found["supported"] == {
        "count": 2,
        "of": 10,
        "low": pytest.approx(0.0252, abs=1e-4),
        "high": pytest.approx(0.5561, abs=1e-4),
    }
    assert found["undecided"]["count"] == 8


@pytest.mark.nightly
def test_the_first_recordings_are_those_of_the_evidence(tmp_path):
    recorded = {(c["seed"], c["kind"]): c for c in evidence.read("rigs_agree")["cases"]}
    for now in run(rigs_agree.cases(NIGHTLY), tmp_path):
        assert now["verdicts"] == recorded[now["seed"], now["kind"]]["verdicts"]


@pytest.mark.long
def test_verdicts_on_a_hundred_and_seventy_recordings():
    done = run(rigs_agree.cases(), evidence.work("rigs_agree", rigs_agree))
    figures = rigs_agree.figures(done)
    seeds = [min(c["seed"] for c in done), max(c["seed"] for c in done)]
    evidence.write("rigs_agree", rigs_agree, seeds=seeds, figures=figures, cases=done)
    assert count(figures, "true", "rigs-agree", "supported") >= 60
    assert count(figures, "true", "rigs-agree", "refuted") <= 2
    assert count(figures, "apart", "rigs-agree", "refuted") >= 45
    assert count(figures, "bare", "coefficients", "supported") == 0

"""Boards that agree are said to, those 12 % apart are not; Table I where it is informed.

Seeds and bounds were fixed before the first run.
"""

import pytest
from campaigns import evidence, rigs_agree


def test_verdicts_are_counted_by_kind_and_claim():
    """Of ten recordings two: 2.5 to 55.6 %, by the tables of Clopper and Pearson."""
    verdicts = ["supported"] * 2 + ["undecided"] * 8
    done = [
        {"kind": kind, "verdicts": dict.fromkeys(rigs_agree.CLAIMS, verdict)}
        for kind in rigs_agree.KINDS
        for verdict in verdicts
    ]
    entry = rigs_agree.figures(done)["apart: rigs-agree"]
    assert entry["supported"] == {
        "count": 2,
        "of": 10,
        "low": pytest.approx(0.0252, abs=1e-4),
        "high": pytest.approx(0.5561, abs=1e-4),
    }
    assert entry["undecided"]["count"] == 8


@pytest.mark.nightly
def test_the_first_recordings_are_those_of_the_evidence(tmp_path):
    recorded = {(c["seed"], c["kind"]): c for c in evidence.read("rigs_agree")["fixed"]}
    for now in rigs_agree.run(rigs_agree.cases(rigs_agree.FIXED), tmp_path):
        assert now["verdicts"] == recorded[now["seed"], now["kind"]]["verdicts"]

"""An effect that is simulated is named, and none where there is none.

Seeds and strengths were fixed before the first run. Six cases and twenty recordings
without an effect are repeated nightly and compared with the evidence.
"""

import numpy as np
import pytest
from campaigns import diagnosis, evidence
from scipy.stats import binomtest

from bayesfric.campaign import run_on_processes

NIGHTLY_CASES = (
    "viscous-1",
    "stribeck-0.3",
    "tension-curvature-1",
    "torque-constant-1",
    "wear-drift-1",
    "viscous+fixed-drag",
)
NIGHTLY_SEEDS = range(20)
AT_LEAST_NO_GAP = 0.95
SHAPE_ONLY = {"runout", "magnet-spacing", "cable-compliance"}
"""Effects that a new trial's prediction cannot have: their phase is nobody's to know."""


def run(function, cases, folder):
    return run_on_processes(function, cases, folder, workers=2)


def no_gap(cases):
    return sum(case["verdict"] == "no-gap" for case in cases)


@pytest.fixture(scope="module")
def repeated(tmp_path_factory):
    cases = {name: diagnosis.cases()[name] for name in NIGHTLY_CASES}
    return run(diagnosis.case, cases, tmp_path_factory.mktemp("diagnosis"))


@pytest.mark.nightly
@pytest.mark.parametrize("name", NIGHTLY_CASES)
def test_each_agrees_with_the_evidence(name, repeated):
    then = evidence.read("diagnosis")["cases"][name]
    now = repeated[name]
    assert (now["verdict"], now["causes"]) == (then["verdict"], then["causes"])
    assert now["right"]
    if then["shrink"] is None:
        assert now["shrink"] is None
    else:
        assert now["shrink"] == pytest.approx(then["shrink"], rel=1e-3)


@pytest.mark.nightly
def test_nothing_is_found_where_there_is_nothing(tmp_path):
    found = run(diagnosis.null_case, {f"{s:04d}": s for s in NIGHTLY_SEEDS}, tmp_path)
    assert no_gap(found.values()) >= AT_LEAST_NO_GAP * len(NIGHTLY_SEEDS)
    then = {case["seed"]: case for case in evidence.read("diagnosis_null")["cases"]}
    for case in found.values():
        before = then[case["seed"]]
        assert case["verdict"] == before["verdict"]
        assert case["probability"] == pytest.approx(before["probability"], abs=1e-3)


@pytest.mark.long
def test_two_hundred_recordings_without_an_effect():
    cases = {f"{seed:04d}": seed for seed in diagnosis.NULL_SEEDS}
    found = list(run(diagnosis.null_case, cases, evidence.WORK / "diagnosis_null").values())
    right = no_gap(found)
    interval = binomtest(right, len(found)).proportion_ci(0.95)
    evidence.write(
        "diagnosis_null",
        diagnosis,
        seeds=[diagnosis.NULL_SEEDS.start, diagnosis.NULL_SEEDS.stop - 1],
        figures={
            "recordings": len(found),
            "no_gap": right,
            "no_gap_95": [interval.low, interval.high],
            "falsely_named": [c["seed"] for c in found if c["verdict"] != "no-gap"],
        },
        cases=found,
    )
    assert right >= AT_LEAST_NO_GAP * len(found)


@pytest.mark.long
def test_every_effect_alone_and_ten_pairs():
    cases = diagnosis.cases()
    found = run(diagnosis.case, cases, evidence.WORK / "diagnosis")
    wrong = {name: case for name, case in found.items() if not case["right"]}
    shrunk = [
        case["shrink"]
        for case in found.values()
        if case["right"] and case["shrink"] is not None and not SHAPE_ONLY & set(case["effects"])
    ]
    covered = [inside for case in found.values() for inside in case["covered"].values()]
    interval = binomtest(sum(covered), len(covered)).proportion_ci(0.95)
    evidence.write(
        "diagnosis",
        diagnosis,
        seeds=[diagnosis.FIRST_SEED, diagnosis.FIRST_SEED + len(cases) - 1],
        figures={
            "cases": len(found),
            "right": len(found) - len(wrong),
            "not_named": {name: [c["verdict"], c["causes"]] for name, c in wrong.items()},
            "median_shrink": float(np.median(shrunk)),
            "parameters_covered": [sum(covered), len(covered)],
            "parameters_covered_95": [interval.low, interval.high],
        },
        cases=found,
    )
    assert float(np.median(shrunk)) >= 0.9

"""Table I is recovered from simulated recordings as often as the intervals say.

Only scatter and noise are drawn anew; the seeds 0…99 were fixed before the first
run. The first twenty are run nightly and each compared with the evidence of the long
run.
"""

import numpy as np
import pytest
from campaigns import evidence, recovery

from bayesfric.campaign import run_on_processes

NIGHTLY_SEEDS = range(20)


def run(seeds, folder):
    cases = {f"{seed:04d}": seed for seed in seeds}
    return list(run_on_processes(recovery.case, cases, folder, workers=2).values())


def check_coverage(cases):
    for level, figures in recovery.coverage(cases).items():
        low, high = figures["bounds"]
        assert low <= figures["coverage"] <= high, f"{level} % intervals: {figures}"


@pytest.fixture(scope="module")
def twenty(tmp_path_factory):
    return run(NIGHTLY_SEEDS, tmp_path_factory.mktemp("recovery"))


@pytest.mark.nightly
def test_coverage_of_twenty_recordings(twenty):
    assert all(case["converged"] for case in twenty)
    check_coverage(twenty)


@pytest.mark.nightly
def test_each_of_the_twenty_agrees_with_the_evidence(twenty):
    """The same seed gives the same posterior, within four Monte Carlo errors."""
    recorded = {case["seed"]: case for case in evidence.read("recovery")["cases"]}
    for case in twenty:
        for name, now in case["coefficients"].items():
            then = recorded[case["seed"]]["coefficients"][name]
            error = np.hypot(now["mcse"], then["mcse"])
            assert abs(now["mean"] - then["mean"]) < 4 * error, (case["seed"], name)
            assert now["sd"] == pytest.approx(then["sd"], rel=0.1)


@pytest.mark.long
def test_coverage_of_a_hundred_recordings():
    cases = run(recovery.SEEDS, evidence.WORK / "recovery")
    figures = recovery.coverage(cases)
    evidence.write(
        "recovery",
        recovery,
        seeds=[recovery.SEEDS.start, recovery.SEEDS.stop - 1],
        figures=figures,
        cases=cases,
    )
    check_coverage(cases)

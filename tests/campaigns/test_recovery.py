"""Table I is recovered from simulated recordings as often as the intervals say.

Only scatter and noise are drawn anew; the seeds 0…99 were fixed before the first
run. Continuous integration runs the first twenty and compares each with the
evidence of the long run.
"""

from functools import cache

import numpy as np
import pytest
from campaigns import evidence, recovery

from bayesfric.campaign import processes, run_campaign

CI_SEEDS = range(20)


def run(seeds, folder):
    with processes(2) as executor:
        cases = {f"{seed:04d}": seed for seed in seeds}
        return list(run_campaign(recovery.case, cases, folder, executor).values())


def check_coverage(cases):
    for level, figures in recovery.coverage(cases).items():
        low, high = figures["bounds"]
        assert low <= figures["coverage"] <= high, f"{level} % intervals: {figures}"


@cache
def first_twenty(folder):
    return run(CI_SEEDS, folder)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("recovery")


def test_coverage_of_twenty_recordings(folder):
    cases = first_twenty(folder)
    assert all(case["converged"] for case in cases)
    check_coverage(cases)


def test_each_of_the_twenty_agrees_with_the_evidence(folder):
    """The same seed gives the same posterior, within four Monte Carlo errors."""
    recorded = {case["seed"]: case for case in evidence.read("recovery")["cases"]}
    for case in first_twenty(folder):
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
        command="make test-long",
        seeds=[recovery.SEEDS.start, recovery.SEEDS.stop - 1],
        figures=figures,
        cases=cases,
    )
    check_coverage(cases)

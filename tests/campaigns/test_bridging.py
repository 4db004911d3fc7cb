"""Bridge sampling errs by as much as it says.

Densities, seeds and bounds were fixed before the first run. The first ten repeats are
run nightly and each compared with the evidence of the long run.
"""

import numpy as np
import pytest
from campaigns import bridging, evidence

from bayesfric.campaign import run_on_processes

NIGHTLY_SEEDS = range(10)


def run(seeds, folder):
    cases = {f"{seed:04d}": seed for seed in seeds}
    return list(run_on_processes(bridging.case, cases, folder, workers=2).values())


def test_a_repeat_is_within_its_reported_errors():
    """Of no seed that the campaign has."""
    for name, found in bridging.case(bridging.SEEDS.stop)["densities"].items():
        assert found["error"] <= 0.02, name
        assert abs(found["difference"]) < 4.5 * found["error"], name


@pytest.fixture(scope="module")
def first_ten(tmp_path_factory):
    return run(NIGHTLY_SEEDS, tmp_path_factory.mktemp("bridging"))


@pytest.mark.nightly
def test_ten_repeats_are_within_three_reported_errors_and_small(first_ten):
    """Of 40 estimates one beyond three errors is chance, two are not."""
    every = [found for case in first_ten for found in case["densities"].values()]
    assert max(found["error"] for found in every) <= 0.02
    far = [found for found in every if abs(found["difference"]) > 3 * found["error"]]
    assert len(far) <= 1
    assert all(abs(found["difference"]) < 4.5 * found["error"] for found in every)


@pytest.mark.nightly
def test_each_of_the_ten_agrees_with_the_evidence(first_ten):
    recorded = {case["seed"]: case for case in evidence.read("bridging")["cases"]}
    for case in first_ten:
        for name, now in case["densities"].items():
            then = recorded[case["seed"]]["densities"][name]
            error = np.hypot(now["error"], then["error"])
            assert abs(now["difference"] - then["difference"]) < 4 * error, (case["seed"], name)
            assert now["error"] == pytest.approx(then["error"], rel=0.5)


def check_calibration(figures):
    low, high = bridging.BOUNDS
    for name, found in figures.items():
        assert low <= found["rms_ratio"] <= high, name


@pytest.mark.nightly
def test_the_evidence_is_calibrated():
    cases = evidence.read("bridging")["cases"]
    assert [case["seed"] for case in cases] == list(bridging.SEEDS)
    check_calibration(bridging.calibration(cases))


@pytest.mark.long
def test_calibration_of_a_hundred_repeats():
    cases = run(bridging.SEEDS, evidence.work("bridging", bridging))
    figures = bridging.calibration(cases)
    evidence.write(
        "bridging",
        bridging,
        seeds=[bridging.SEEDS.start, bridging.SEEDS.stop - 1],
        figures=figures,
        cases=cases,
    )
    check_calibration(figures)

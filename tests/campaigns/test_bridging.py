"""Bridge sampling errs by as much as it says.

Densities, seeds and bounds were fixed before the first run. The first ten repeats are
run nightly and each compared with the evidence.
"""

import numpy as np
import pytest
from campaigns import bridging, evidence

from bayesfric.campaign import run_on_processes


def test_a_repeat_is_within_its_reported_errors():
    """Of no seed that the campaign has."""
    for name, record in bridging.case(bridging.SEEDS.stop)["densities"].items():
        assert record["error"] <= 0.02, name
        assert abs(record["difference"]) < 4.5 * record["error"], name


@pytest.fixture(scope="module")
def first_ten(tmp_path_factory):
    cases = {f"{seed:04d}": seed for seed in bridging.FIXED_SEEDS}
    folder = tmp_path_factory.mktemp("bridging")
    return list(run_on_processes(bridging.case, cases, folder, workers=2).values())


@pytest.mark.nightly
def test_ten_repeats_are_within_three_reported_errors_and_small(first_ten):
    """Of 40 estimates one beyond three errors is chance, two are not."""
    every = [record for case in first_ten for record in case["densities"].values()]
    assert max(record["error"] for record in every) <= 0.02
    far = [record for record in every if abs(record["difference"]) > 3 * record["error"]]
    assert len(far) <= 1
    assert all(abs(record["difference"]) < 4.5 * record["error"] for record in every)


@pytest.mark.nightly
def test_each_of_the_ten_agrees_with_the_evidence(first_ten):
    recorded = {case["seed"]: case for case in evidence.read("bridging")["fixed"]}
    for case in first_ten:
        for name, now in case["densities"].items():
            then = recorded[case["seed"]]["densities"][name]
            error = np.hypot(now["error"], then["error"])
            assert abs(now["difference"] - then["difference"]) < 4 * error, (case["seed"], name)
            assert now["error"] == pytest.approx(then["error"], rel=0.5)

"""Posterior probabilities of hypotheses are right as often as they say.

The seeds 0…399 of each effect were fixed before the first run. Continuous integration
weighs the first twenty of each again and compares with the evidence of the long run.
"""

from functools import cache

import numpy as np
import pytest
from campaigns import calibration, evidence

from bayesfric.campaign import processes, run_campaign

CI_SEEDS = range(20)
LEAST_OPEN = 0.4
EFFECTS = [name for name, _ in calibration.AMPLITUDES]


def run(seeds, folder):
    cases = {
        f"{name}-{seed:04d}": (name, law, seed)
        for name, law in calibration.AMPLITUDES
        for seed in seeds
    }
    with processes(2) as executor:
        return list(run_campaign(calibration.case, cases, folder, executor).values())


def of_effect(cases, name):
    own = [case for case in cases if case["effect"] == name]
    log_factor = np.array([case["log_bayes_factor"] for case in own])
    return log_factor, np.array([case["acts"] for case in own])


def faults(found):
    """Return which checks the figures fail."""
    failed = [
        f"reliability at {one['mean_probability']:.2f}"
        for one in found["reliability"]
        if not one["band"][0] <= one["frequency"] <= one["band"][1]
    ]
    if abs(found["spiegelhalter_z"]) >= 2:
        failed.append("spiegelhalter")
    bounded = found["good_with_effect"]  # its factors are bounded: an error is an error
    if abs(bounded["mean"] - 1) >= 3 * bounded["standard_error"]:
        failed.append("good with effect")
    low, high = found["good_without_effect"]["band_99"]
    if not low <= found["good_without_effect"]["mean"] <= high or not low <= 1 <= high:
        failed.append("good without effect")
    return failed


@cache
def first(folder):
    return run(CI_SEEDS, folder)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("calibration")


def test_each_agrees_with_the_evidence(folder):
    cases = {(one["effect"], one["seed"]): one for one in evidence.read("calibration")["cases"]}
    for now in first(folder):
        then = cases[now["effect"], now["seed"]]
        assert now["acts"] == then["acts"]
        assert now["amplitude"] == pytest.approx(then["amplitude"], rel=1e-9)
        error = np.hypot(now["error"], then["error"])
        assert abs(now["log_bayes_factor"] - then["log_bayes_factor"]) < 4 * error, now


def test_forty_are_calibrated(folder):
    cases = first(folder)
    log_factor = np.array([case["log_bayes_factor"] for case in cases])
    acts = np.array([case["acts"] for case in cases])
    assert abs(calibration.spiegelhalter(1 / (1 + np.exp(-log_factor)), acts)) < 2


@pytest.mark.parametrize("name", EFFECTS)
def test_wrong_bayes_factors_would_be_noticed(name):
    """The evidence with all Bayes factors doubled or halved, or their logarithms, fails."""
    log_factor, acts = of_effect(evidence.read("calibration")["cases"], name)
    for wrong in (log_factor + np.log(2), log_factor - np.log(2), 2 * log_factor, log_factor / 2):
        assert faults(calibration.figures(wrong, acts))


def test_spiegelhalter_by_hand():
    """The sums of its definition, written out for three cases."""
    p = np.array([0.1, 0.9, 0.3])
    z = calibration.spiegelhalter(p, np.array([True, True, False]))
    # 0.9·0.8 + 0.1·(−0.8) + (−0.3)·0.4 = 0.52; 2·0.64·0.09 + 0.16·0.21 = 0.1488
    assert z == pytest.approx(0.52 / np.sqrt(0.1488), rel=1e-12)


def test_figures_of_a_conjugate_pair():
    """Bayes factors in closed form: y ~ N(a, 1) with a = 0 or a ~ N(0, 2²)."""
    rng = np.random.default_rng(1)
    acts = rng.uniform(size=4000) < 0.5
    y = rng.standard_normal(4000) + 2 * rng.standard_normal(4000) * acts
    log_factor = -0.5 * np.log(5) + 0.4 * y**2  # N(y; 0, 5) over N(y; 0, 1)
    assert faults(calibration.figures(log_factor, acts)) == []
    assert faults(calibration.figures(log_factor + 0.3, acts))


@pytest.mark.long
def test_four_hundred_of_each_effect():
    cases = run(calibration.SEEDS, evidence.WORK / "calibration")
    found = {name: calibration.figures(*of_effect(cases, name)) for name in EFFECTS}
    evidence.write(
        "calibration",
        command="make test-long",
        seeds=[calibration.SEEDS.start, calibration.SEEDS.stop - 1],
        figures=found | {"stalled_trials": sum(case["stalled"] for case in cases)},
        cases=cases,
    )
    assert not any(case["stalled"] for case in cases)
    for name, figures in found.items():
        assert figures["share_open"] >= LEAST_OPEN, name
        assert faults(figures) == [], name

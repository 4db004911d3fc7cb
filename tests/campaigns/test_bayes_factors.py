"""Posterior probabilities of hypotheses are right as often as they say.

The seeds 0…399 of each effect were fixed before the first run. The first
twenty of each are weighed again nightly and compared with the evidence of the long run.
"""

import numpy as np
import pytest
from campaigns import bayes_factors, evidence

from bayesfric.campaign import run_on_processes

NIGHTLY_SEEDS = range(20)
LEAST_OPEN = 0.4
EFFECTS = [name for name, _ in bayes_factors.AMPLITUDES]


def run(seeds, folder):
    cases = {
        f"{name}-{seed:04d}": (name, law, seed)
        for name, law in bayes_factors.AMPLITUDES
        for seed in seeds
    }
    return list(run_on_processes(bayes_factors.case, cases, folder, workers=2).values())


def of_effect(cases, name):
    """Return log Bayes factors, those of the narrower prior, and where the effect acts."""
    own = [case for case in cases if case["effect"] == name]
    columns = "log_bayes_factor", "narrow_log_bayes_factor", "acts"
    return tuple(np.array([case[column] for case in own]) for column in columns)


def faults(found):
    """Return which checks the figures fail."""
    failed = [
        f"reliability at {one['mean_probability']:.2f}"
        for one in found["reliability"]
        if not one["band"][0] <= one["frequency"] <= one["band"][1]
    ]
    if abs(found["spiegelhalter_z"]) >= 2:
        failed.append("spiegelhalter")
    for name in ("good_without_effect", "good_with_effect"):
        if abs(found[name]["mean"] - 1) >= 3 * found[name]["standard_error"]:
            failed.append(name)
    whole = found["whole_width_without_effect"]
    if not whole["band_99"][0] <= whole["mean"] <= whole["band_99"][1]:
        failed.append("whole width")
    return failed


@pytest.fixture(scope="module")
def repeated(tmp_path_factory):
    return run(NIGHTLY_SEEDS, tmp_path_factory.mktemp("bayes_factors"))


@pytest.mark.nightly
def test_each_agrees_with_the_evidence(repeated):
    cases = {(one["effect"], one["seed"]): one for one in evidence.read("bayes_factors")["cases"]}
    for now in repeated:
        then = cases[now["effect"], now["seed"]]
        assert now["acts"] == then["acts"]
        assert now["amplitude"] == pytest.approx(then["amplitude"], rel=1e-9)
        error = np.hypot(now["error"], then["error"])
        assert abs(now["log_bayes_factor"] - then["log_bayes_factor"]) < 4 * error, now


@pytest.mark.nightly
def test_forty_are_calibrated(repeated):
    log_factor = np.array([case["log_bayes_factor"] for case in repeated])
    acts = np.array([case["acts"] for case in repeated])
    assert abs(bayes_factors.spiegelhalter(1 / (1 + np.exp(-log_factor)), acts)) < 2


@pytest.mark.nightly
@pytest.mark.parametrize("name", EFFECTS)
def test_wrong_bayes_factors_would_be_noticed(name):
    """The evidence with all Bayes factors doubled or halved, or their logarithms, fails."""
    log_factor, narrow, acts = of_effect(evidence.read("bayes_factors")["cases"], name)
    for power, shift in ((1, np.log(2)), (1, -np.log(2)), (2, 0), (0.5, 0)):
        wrong = bayes_factors.figures(power * log_factor + shift, power * narrow + shift, acts)
        assert faults(wrong), (power, shift)


def test_spiegelhalter_by_hand():
    """The sums of its definition, written out for three cases."""
    p = np.array([0.1, 0.9, 0.3])
    z = bayes_factors.spiegelhalter(p, np.array([True, True, False]))
    # 0.9·0.8 + 0.1·(−0.8) + (−0.3)·0.4 = 0.52; 2·0.64·0.09 + 0.16·0.21 = 0.1488
    assert z == pytest.approx(0.52 / np.sqrt(0.1488), rel=1e-12)


def conjugate_pair(seed, size=400):
    """Bayes factors in closed form: y ~ N(a, 1) with a = 0 or a ~ N(0, 2²)."""
    rng = np.random.default_rng(seed)
    acts = rng.uniform(size=size) < 0.5
    y = rng.standard_normal(size) + 2 * rng.standard_normal(size) * acts

    def log_factor(variance):  # N(y; 0, 1 + variance) over N(y; 0, 1)
        return -0.5 * np.log1p(variance) + 0.5 * y**2 * variance / (1 + variance)

    return log_factor(4.0), log_factor(0.4), acts


def test_figures_of_a_conjugate_pair():
    log_factor, narrow, acts = conjugate_pair(1)
    found = bayes_factors.figures(log_factor, narrow, acts)
    assert faults(found) == []
    shifted = " ".join(faults(bayes_factors.figures(log_factor + 0.7, narrow + 0.7, acts)))
    for check in ("reliability", "spiegelhalter", "good_without_effect", "good_with_effect"):
        assert check in shifted
    # The frequencies are those of the bins: counted again, they make up all that act.
    acting = sum(one["frequency"] * one["recordings"] for one in found["reliability"])
    assert acting == pytest.approx(acts.sum(), rel=1e-12)


@pytest.mark.long
def test_four_hundred_of_each_effect():
    cases = run(bayes_factors.SEEDS, evidence.work("bayes_factors", bayes_factors))
    found = {name: bayes_factors.figures(*of_effect(cases, name)) for name in EFFECTS}
    evidence.write(
        "bayes_factors",
        bayes_factors,
        seeds=[bayes_factors.SEEDS.start, bayes_factors.SEEDS.stop - 1],
        figures=found | {"stalled_trials": sum(case["stalled"] for case in cases)},
        cases=cases,
    )
    assert not any(case["stalled"] for case in cases)
    for name, figures in found.items():
        assert figures["share_open"] >= LEAST_OPEN, name
        assert faults(figures) == [], name

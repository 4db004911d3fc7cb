"""Posterior probabilities of hypotheses are right as often as they say.

The seeds 0…399 of each effect were fixed before the first run. The first
twenty of each are weighed again nightly and compared with the evidence.
"""

import numpy as np
import pytest
from campaigns import bayes_factors, evidence

from bayesfric.campaign import run_on_processes

SIZE = 400  # recordings of a conjugate pair, as many as the campaign has of an effect


@pytest.fixture(scope="module")
def repeated(tmp_path_factory):
    cases = bayes_factors.cases(bayes_factors.FIXED_SEEDS)
    folder = tmp_path_factory.mktemp("bayes_factors")
    return list(run_on_processes(bayes_factors.case, cases, folder, workers=2).values())


@pytest.mark.nightly
def test_each_agrees_with_the_evidence(repeated):
    cases = {
        (record["effect"], record["seed"]): record
        for record in evidence.read("bayes_factors")["fixed"]
    }
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


def test_spiegelhalter_by_hand():
    """The sums of its definition, written out for three cases."""
    p = np.array([0.1, 0.9, 0.3])
    z = bayes_factors.spiegelhalter(p, np.array([True, True, False]))
    # 0.9·0.8 + 0.1·(−0.8) + (−0.3)·0.4 = 0.52; 2·0.64·0.09 + 0.16·0.21 = 0.1488
    assert z == pytest.approx(0.52 / np.sqrt(0.1488), rel=1e-12)


def conjugate_pair(seed, size=SIZE):
    """Bayes factors in closed form: y ~ N(a, 1) with a = 0 or a ~ N(0, 2²)."""
    rng = np.random.default_rng(seed)
    acts = rng.uniform(size=size) < 0.5
    y = rng.standard_normal(size) + 2 * rng.standard_normal(size) * acts

    def log_factor(variance):  # N(y; 0, 1 + variance) over N(y; 0, 1)
        return -0.5 * np.log1p(variance) + 0.5 * y**2 * variance / (1 + variance)

    return log_factor(4.0), log_factor(0.4), acts


def figures(log_factor, narrow, acts):
    return bayes_factors.figures(log_factor, narrow, acts)


def test_figures_of_a_conjugate_pair():
    log_factor, narrow, acts = conjugate_pair(1)
    entry = figures(log_factor, narrow, acts)
    assert bayes_factors.faults(entry) == []
    shifted = " ".join(bayes_factors.faults(figures(log_factor + 0.7, narrow + 0.7, acts)))
    for check in ("bins", "Spiegelhalter", "identity without", "identity with the"):
        assert check in shifted
    # The frequencies are those of the bins: counted again, they make up all that act.
    acting = sum(point["frequency"] * point["recordings"] for point in entry["reliability"])
    assert acting == pytest.approx(acts.sum(), rel=1e-12)


@pytest.mark.parametrize(("power", "shift"), [(1, np.log(2)), (1, -np.log(2)), (2, 0), (0.5, 0)])
def test_wrong_bayes_factors_are_noticed(power, shift):
    """All Bayes factors doubled or halved, or their logarithms, break a promise."""
    log_factor, narrow, acts = conjugate_pair(1)
    assert bayes_factors.faults(figures(power * log_factor + shift, power * narrow + shift, acts))

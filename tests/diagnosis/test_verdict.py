"""The rules of the verdict, and the probabilities that they rest on."""

from math import comb

import numpy as np
import pytest

from bayesfric.diagnosis.classes import Classes
from bayesfric.diagnosis.verdict import decide
from bayesfric.diagnosis.which import PRIOR, Which

GAP = np.full(100, 0.2)  # N, above a practical 0.1
NO_GAP = np.full(100, 0.05)


@pytest.mark.parametrize(
    ("chances", "gap", "verdict", "chance"),
    [
        ({"none": 0.5, "viscous": 0.5}, GAP, "no-gap", 0.5),
        ({"none": 0.1, "viscous": 0.9}, NO_GAP, "no-gap", 1.0),
        ({"none": 0.1, "unknown": 0.5, "viscous": 0.4}, GAP, "unknown", 0.5),
        # No cause takes anything away from an unknown force: that is no sign of no gap.
        ({"none": 0.1, "unknown": 0.5, "viscous": 0.4}, NO_GAP, "unknown", 0.5),
        ({"none": 0.05, "unknown": 0.05, "viscous": 0.9}, GAP, "named", 0.9),
        ({"none": 0.1, "unknown": 0.1, "viscous": 0.5, "slip": 0.3}, GAP, "unseparated", 0.8),
    ],
)
def test_rules(chances, gap, verdict, chance):
    found, probability = decide(chances, gap, 0.1)
    assert found == verdict
    assert probability == pytest.approx(chance)


def which(log_evidence):
    names = [f"e{k}" for k in range(5)]
    classes = Classes(tuple((name,) for name in names), (), {})
    return Which(log_evidence, {}, classes, None, frozenset(), 0.0)


def test_prior_is_shared_within_a_number_of_effects():
    """Five effects: all singles, pairs, larger sets and the two others make 1."""
    asked = which({})
    single, pair, triple = (np.exp(asked.log_prior(n)) for n in ("e0", "e0+e1", "e0+e1+e2"))
    total = 5 * single + comb(5, 2) * pair + comb(5, 3) * triple
    total += np.exp(asked.log_prior("none")) + np.exp(asked.log_prior("unknown"))
    assert total == pytest.approx(1.0)
    assert single == pytest.approx(PRIOR["one"] / 5)


def test_posterior_is_prior_times_evidence():
    chances = which({"none": 0.0, "e0": np.log(30.0), "unknown": np.log(2.0)}).probabilities()
    weights = {"none": 0.5, "e0": 30 * 0.06, "unknown": 0.2}
    for name, weight in weights.items():
        assert chances[name] == pytest.approx(weight / sum(weights.values()))


def test_another_prior_of_none_scales_the_rest():
    """From 0.5 to 0.1: the odds of an effect against none grow by 9."""
    asked = which({"none": 0.0, "e0": 3.0, "unknown": 0.0})
    odds = [
        chances["e0"] / chances["none"]
        for chances in (asked.probabilities(), asked.probabilities(0.1))
    ]
    assert odds[1] / odds[0] == pytest.approx(9.0)

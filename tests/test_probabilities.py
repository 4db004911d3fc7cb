"""Sums of probabilities are probabilities, whatever rounding does."""

import math

import numpy as np
import pytest

from bayesfric.analysis import Analysis
from bayesfric.diagnosis.acting import Acting, At
from bayesfric.diagnosis.classes import Classes
from bayesfric.diagnosis.hypotheses import Search
from bayesfric.diagnosis.systematic import inclusion
from bayesfric.diagnosis.verdict import KnownEffect, decide
from bayesfric.diagnosis.weighing import Weighed
from bayesfric.hypothesis import NONE, Hypothesis, printed
from bayesfric.probabilities import in_thousands, normalised, stated, total

# Four parts of one that floating-point addition makes larger than one.
ABOVE_ONE = (0.28, 0.34, 0.32, 0.06)


def test_rounding_above_one_is_one():
    assert sum(ABOVE_ONE) > 1
    assert total(ABOVE_ONE) == 1.0
    assert stated(total(ABOVE_ONE)) == "> 0.999"
    assert total([0.25, 0.5]) == 0.75
    assert total([]) == 0.0
    assert total([0.3, -0.3 - 1e-17]) == 0.0


@pytest.mark.parametrize("parts", [[0.7, 0.4], [-0.1], [math.nan]])
def test_what_is_no_sum_of_probabilities_is_refused(parts):
    with pytest.raises(ValueError, match="add up to 1"):
        total(parts)


def test_normalised_weights_are_probabilities():
    probabilities = normalised({"a": 3.0, "b": 1.0, "c": -1e-17})
    assert probabilities == {"a": 0.75, "b": 0.25, "c": 0.0}
    assert normalised({"a": 1.0000000000000002}) == {"a": 1.0}
    for wrong in ({"a": -1.0, "b": 2.0}, {"a": math.nan}, {"a": 0.0}, {}):
        with pytest.raises(ValueError, match="weight"):
            normalised(wrong)


def test_a_verdict_of_several_hypotheses_that_add_up_to_more_than_one_is_stated():
    chances = {
        Hypothesis(("viscous", name)): part for name, part in zip("abcd", ABOVE_ONE, strict=True)
    }
    verdict, probability = decide(chances, [KnownEffect("viscous", 1.0, 1.0, 0.1)], 1.0, ())
    assert (verdict, probability) == ("named", 1.0)


@pytest.mark.parametrize("seed", range(20))
def test_hypotheses_add_up_to_one_where_much_of_them_counts_as_unknown(seed):
    rng = np.random.default_rng(seed)
    nothing = np.zeros(0)
    at = At(nothing, 0.0, None, None, nothing, np.zeros((0, 0)), at_mode=True)
    names = ["none", "a", "b", "a+b", "a+c", "b+c", "a+b+c"]
    weighed = {
        hypothesis: Weighed(hypothesis.names, rng.normal(0, 3), None, Acting(), at)
        for hypothesis in map(Hypothesis.parse, names)
    }
    classes = Classes((("a",), ("b",), ("c",)), (), {})
    foreign = {Hypothesis("a"): 1.0, Hypothesis("b"): rng.uniform()}
    search = Search(
        weighed, {}, None, classes, Analysis().diagnosis.hypotheses, np.eye(1), 0.0, foreign
    )
    chances = search.probabilities()
    assert abs(math.fsum(chances.values()) - 1) < 1e-15
    assert all(0 <= chance <= 1 for chance in chances.values())
    assert all(0 <= chance <= 1 for chance in inclusion(search).values())


def test_an_unknown_force_of_which_data_say_nothing_keeps_its_prior():
    """One in six, beside none: 0.1 against 0.5."""
    nothing = np.zeros(0)
    at = At(nothing, 0.0, None, None, nothing, np.zeros((0, 0)), at_mode=True)
    weighed = {NONE: Weighed((), -3.0, None, Acting(), at)}
    priors = Analysis().diagnosis.hypotheses
    search = Search(
        weighed, {}, None, Classes((), (), {}), priors, np.eye(1), 0.0, nothing_varied=True
    )
    assert printed(search.probabilities()) == pytest.approx({"none": 5 / 6, "unknown": 1 / 6})


@pytest.mark.parametrize(
    ("value", "written"),
    [(0.00416, "4.16e-3"), (0.04393, "43.9e-3"), (2.79e-5, "27.9e-6"), (-0.00099996, "-1.00e-3"),
     (0.25, "0.250"), (1.5, "1.50"), (0.0, "0.00")],
)  # fmt: skip
def test_small_numbers_have_powers_of_a_thousand(value, written):
    assert in_thousands(value) == written

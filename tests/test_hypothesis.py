"""A hypothesis is a set of effects; text stands for it in files alone."""

import pickle

import pytest

from bayesfric.hypothesis import NONE, UNKNOWN, Hypothesis, parsed, printed


@pytest.mark.parametrize(
    ("text", "names"),
    [("none", ()), ("slip", ("slip",)), ("slip+viscous", ("slip", "viscous"))],
)
def test_a_hypothesis_is_written_by_the_names_of_its_effects(text, names):
    hypothesis = Hypothesis(reversed(names))
    assert str(hypothesis) == text
    assert Hypothesis.parse(text) == hypothesis
    assert hypothesis.names == tuple(hypothesis) == names
    assert pickle.loads(pickle.dumps(hypothesis)) == hypothesis


def test_none_is_empty_and_an_unknown_force_is_no_effect():
    assert not NONE
    assert str(UNKNOWN) == "unknown"
    assert NONE.with_effects("b", "a").with_effects("b") == Hypothesis("ab")


def test_probabilities_are_read_as_they_were_written():
    written = {"b+c": 0.6, "a": 0.3, "none": 0.1}
    assert list(printed(parsed(written)).items()) == list(written.items())

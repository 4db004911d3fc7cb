"""Thresholds of an engine: each has a unit and a sentence, and none can be changed on the way."""

from dataclasses import FrozenInstanceError, dataclass

import pytest

from bayesfric.inference.sampling_rules import SAMPLING_RULES
from bayesfric.margins.margin_rules import MARGIN_RULES
from bayesfric.rules import Rule, rule, rules_of

ENGINES = (MARGIN_RULES, SAMPLING_RULES)


@dataclass(frozen=True)
class Bench:
    longest: float = rule(2.5, "s", "a run that takes longer is left out")


def test_a_rule_has_name_value_unit_and_sentence():
    assert rules_of(Bench()) == (Rule("longest", 2.5, "s", "a run that takes longer is left out"),)


@pytest.mark.parametrize("rules", ENGINES, ids=lambda rules: type(rules).__name__)
def test_each_threshold_of_an_engine_says_what_it_decides(rules):
    for name, value, unit, sentence in rules_of(rules):
        assert value > 0, name
        assert unit, name
        assert len(sentence.split()) > 4, name


@pytest.mark.parametrize("rules", ENGINES, ids=lambda rules: type(rules).__name__)
def test_a_threshold_cannot_be_changed_on_the_way(rules):
    with pytest.raises(FrozenInstanceError):
        setattr(rules, rules_of(rules)[0].name, 0.0)

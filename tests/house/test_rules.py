"""Thresholds of an engine: each has a unit, a sentence and a page, and none can be changed."""

from dataclasses import FrozenInstanceError, dataclass, fields
from pathlib import Path

import pytest

from bayesfric.diagnosis_rules import RULES
from bayesfric.inference.sampling_rules import SAMPLING_RULES
from bayesfric.margins.margin_rules import MARGIN_RULES
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rules import Rule, rules_of

ENGINES = (MARGIN_RULES, SAMPLING_RULES, RULES, AXIS_RULES)
DECISIONS = Path(__file__).parents[2] / "docs" / "decisions"


@dataclass(frozen=True)
class Bench:
    """Thresholds of a bench.

    Fields
    ------
    longest: a run that takes longer is left out [s; rigs]
    """

    longest: float = 2.5


def test_a_rule_has_name_value_unit_and_sentence():
    said = Rule("longest", 2.5, "s", "a run that takes longer is left out", "rigs")
    assert rules_of(Bench()) == (said,)


@pytest.mark.parametrize("rules", ENGINES, ids=lambda rules: type(rules).__name__)
def test_each_threshold_of_an_engine_says_what_it_decides(rules):
    assert [said.name for said in rules_of(rules)] == [entry.name for entry in fields(rules)]
    for name, value, unit, sentence, page in rules_of(rules):
        assert value > 0, name
        assert unit, name
        assert len(sentence.split()) > 4, name
        assert (DECISIONS / f"{page}.md").is_file(), name


@pytest.mark.parametrize("rules", ENGINES, ids=lambda rules: type(rules).__name__)
def test_a_threshold_cannot_be_changed_on_the_way(rules):
    with pytest.raises(FrozenInstanceError):
        setattr(rules, rules_of(rules)[0].name, 0.0)

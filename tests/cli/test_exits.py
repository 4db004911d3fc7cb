"""What ``--fail-on`` can name and tells, as docs of the commands state it."""

from typing import get_args

import pytest
import typer

from bayesfric.cli.exits import FAILURES, VERDICT_FAILURES, check_fail_on, fail_on
from bayesfric.diagnosis.verdict import Verdict
from bayesfric.errors import InputError


@pytest.mark.parametrize(
    ("verdict", "failures"),
    [
        ("named", {"gap"}),
        ("unseparated", {"gap"}),
        ("unknown", {"gap"}),
        ("undecided", {"undecided"}),
        ("no-gap", set()),
    ],
)
def test_a_verdict_is_a_failure_or_none(verdict, failures):
    assert VERDICT_FAILURES[verdict] == failures


def test_every_verdict_is_known_to_it():
    assert set(VERDICT_FAILURES) == set(get_args(Verdict))
    assert set().union(*VERDICT_FAILURES.values()) <= set(FAILURES)


def test_all_that_happened_is_told_and_nothing_that_was_not_asked_for(capsys):
    with pytest.raises(typer.Exit) as end:
        fail_on("spec,gap, refuted,undecided", {"refuted", "gap", "attention", "spec"})
    assert end.value.exit_code == 1
    assert capsys.readouterr().err == "failed: refuted\nfailed: gap\nfailed: spec\n"


def test_what_did_not_happen_ends_nothing(capsys):
    fail_on("undecided", {"refuted", "attention"})
    fail_on("", {"refuted", "attention"})
    assert capsys.readouterr() == ("", "")


def test_each_unknown_name_is_a_fault():
    with pytest.raises(InputError) as error:
        check_fail_on("rain,gap,snow", "run")
    assert [fault.value for fault in error.value.faults] == ["rain", "snow"]


def test_the_words_of_the_contract_can_be_named():
    words = {"refuted", "unconverged", "attention", "gap", "undecided", "spec"}
    assert words <= set(FAILURES)

"""What a verdict is to ``--fail-on``, as docs of the commands state it."""

from typing import get_args

import pytest

from bayesfric.cli.exits import FAILURES, failures_of
from bayesfric.diagnosis.verdict import Verdict


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
    assert failures_of(verdict) == failures


def test_every_verdict_is_known_to_it():
    assert set().union(*map(failures_of, get_args(Verdict))) <= set(FAILURES)

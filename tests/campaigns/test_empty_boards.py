"""Of eight empty boards none is named, and bands of where the gap lies hold zero."""

from types import SimpleNamespace

import pytest
from campaigns import empty_boards, evidence


@pytest.mark.parametrize(
    ("low", "high", "leaves"),
    [((-1, -1), (1, 1), False), ((-1, 0.1), (1, 1), True), ((-1, -1), (1, -0.1), True)],
)
def test_a_band_leaves_zero_where_one_end_crosses_it(low, high, leaves):
    assert empty_boards.leaves_zero(SimpleNamespace(low_n=low, high_n=high)) is leaves


def test_figures_by_hand():
    done = [
        {"verdict": "no-gap", "causes": [], "panels": 9, "without_zero": ["velocity"]},
        {"verdict": "named", "causes": ["viscous"], "panels": 7, "without_zero": []},
    ]
    summary = empty_boards.figures(done)
    assert summary["verdicts"] == {"no-gap": 1, "undecided": 0}
    assert (summary["named"], summary["panels"], summary["without_zero"]) == (1, 16, 1)
    assert summary["share"] == 1 / 16


@pytest.mark.nightly
def test_the_first_board_is_that_of_the_evidence():
    for then in evidence.read("empty_boards")["fixed"]:
        now = empty_boards.case(then["seed"])
        probability = pytest.approx(then.pop("probability"), abs=1e-3)
        assert now.pop("probability") == probability
        assert now == then

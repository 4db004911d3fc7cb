"""Of eight empty boards none is named, and bands of where the gap lies hold zero."""

from types import SimpleNamespace

import pytest
from campaigns import empty_boards, evidence

from bayesfric.campaign import run_on_processes


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
    found = empty_boards.figures(done)
    assert found["verdicts"] == {"no-gap": 1, "undecided": 0}
    assert (found["named"], found["panels"], found["without_zero"]) == (1, 16, 1)
    assert found["share"] == 1 / 16


@pytest.mark.long
def test_eight_empty_boards():
    folder = evidence.work("empty_boards", empty_boards)
    done = list(
        run_on_processes(empty_boards.case, empty_boards.cases(), folder, workers=2).values()
    )
    figures = empty_boards.figures(done)
    seeds = [empty_boards.SEEDS.start, empty_boards.SEEDS.stop - 1]
    evidence.write("empty_boards", empty_boards, seeds=seeds, figures=figures, cases=done)
    assert sum(figures["verdicts"].values()) == figures["boards"]
    assert figures["named"] == 0
    assert figures["share"] <= empty_boards.MOST

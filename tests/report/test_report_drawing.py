"""Figures are the same whoever draws them, and are drawn by whoever is free."""

from concurrent.futures import BrokenExecutor, Executor, Future

import pytest
from report.sample import document

from bayesfric.campaign import processes
from bayesfric.plots.posterior import coefficients_relative_to_paper
from bayesfric.plots.residuals_by_order import residuals_by_order
from bayesfric.plots.style import svg_of
from bayesfric.report.content import Document, Figure
from bayesfric.report.drawing import draw_figures, get_ready, typeset


class Helper(Executor):
    """Does at once what it is asked for, never, or dies of it."""

    def __init__(self, kind: str) -> None:
        self.kind, self.asked = kind, []

    def submit(self, fn, /, *args, **kwargs):
        self.asked.append(fn)
        future = Future()
        if self.kind == "fast":
            future.set_result(fn(*args, **kwargs))
        if self.kind == "dead":
            future.set_exception(BrokenExecutor("it was killed"))
        return future


def pictures(shown: Document) -> list[bytes]:
    return [block.svg for block in shown.blocks if isinstance(block, Figure)]


def numbered(count: int) -> Document:
    figures = [Figure((lambda k=k: b"<svg>%d" % k), "Some.", "One.") for k in range(count)]
    return Document("Title", "", figures)


@pytest.mark.parametrize("kind", ["fast", "slow", "dead"])
def test_each_figure_is_its_own_whoever_draws_it(kind):
    assert pictures(draw_figures(numbered(5), Helper(kind))) == [b"<svg>%d" % k for k in range(5)]


def test_the_helper_begins_with_the_first_and_this_process_with_the_last():
    helper, plain = Helper("slow"), numbered(3)
    draw_figures(plain, helper)
    assert helper.asked == [block.draw for block in plain.blocks]


def test_nothing_else_of_a_document_changes():
    plain = document()
    drawn = draw_figures(plain, Helper("slow"))
    others = [block for block in plain.blocks if not isinstance(block, Figure)]
    assert [block for block in drawn.blocks if not isinstance(block, Figure)] == others
    assert pictures(drawn) == pictures(plain)


def test_a_fault_of_a_figure_is_told_and_not_hidden():
    def broken():
        raise ZeroDivisionError("by the figure")

    plain = Document("Title", "", [Figure(broken, "Some.", "One.")])
    for kind in ("slow",):
        with pytest.raises(ZeroDivisionError, match="by the figure"):
            draw_figures(plain, Helper(kind))


def test_another_process_draws_the_same_bytes(small_fit):
    draws = [
        svg_of(coefficients_relative_to_paper, small_fit.predictive),
        svg_of(residuals_by_order, small_fit.predictive),
    ]
    with processes(1) as helper:
        get_ready(helper)
        there = [helper.submit(draw).result() for draw in draws]
    assert there == [draw() for draw in draws]


@pytest.mark.parametrize("kind", ["fast", "dead"])
def test_a_helper_typesets_once_and_the_pdf_is_its_own(kind):
    plain, helper = Document("Title", "", numbered(0).blocks), Helper(kind)
    assert typeset(plain, helper) == typeset(plain)
    assert helper.asked == [typeset]

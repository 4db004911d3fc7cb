"""Panels leave room for what is written around them, as matplotlib itself measures it."""

import io
from itertools import combinations

import pytest
from matplotlib import textpath
from matplotlib.backends.backend_svg import RendererSVG
from matplotlib.lines import Line2D

from bayesfric.plots.labels import (
    CommonFactor,
    columns_of,
    numbers,
    power_of_ten,
    powers,
    rounded,
)
from bayesfric.plots.style import figure, halves, key, to_svg

CLOSE = 1.5  # points by which matplotlib's boxes of words may differ from ours


def laid_out(fig):
    """Lay a figure out, and return the box around each panel with its words, in points."""
    fig.get_layout_engine().execute(fig)
    fig.dpi = 72
    renderer = RendererSVG(*fig.bbox.size, io.StringIO(), image_dpi=72)
    return renderer, [axes.get_tightbbox(renderer) for axes in fig.axes if axes.get_visible()]


def overlap(box, other):
    across = min(box.x1, other.x1) - max(box.x0, other.x0)
    up = min(box.y1, other.y1) - max(box.y0, other.y0)
    return min(across, up)


def panels(fig):
    grid = fig.subplots(2, 3)
    for place, axes in enumerate(grid.flat):
        axes.plot([0, 10.0**place], [1e-3, 2.5])
        axes.set_title(f"$c_{place}$ of\nthat")
        axes.set_xlabel("tension [N]")
        axes.set_ylabel("friction\n[N]")
    return grid


def test_panels_with_their_words_lie_apart_and_inside_the_figure():
    with figure(height=90) as fig:
        panels(fig)
        _, boxes = laid_out(fig)
    for first, other in combinations(boxes, 2):
        assert overlap(first, other) < CLOSE
    for box in boxes:
        assert box.x0 > -CLOSE
        assert box.y0 > -CLOSE
        assert box.x1 < fig.bbox.width + CLOSE
        assert box.y1 < fig.bbox.height + CLOSE


def test_panels_take_the_room_that_is_left():
    with figure(width=100, height=50) as fig:
        axes = fig.subplots()
        axes.plot([0, 1], [0, 1])
        _, (box,) = laid_out(fig)
    free = 2 * 5.0  # points that are kept clear, left and right together
    assert box.width == pytest.approx(fig.bbox.width - free, abs=CLOSE)


@pytest.mark.parametrize("side", ["above", "below"])
def test_a_key_lies_beside_the_panels(side):
    with figure(height=60) as fig:
        panels(fig)
        legend = key(fig, [Line2D([], [], label="one"), Line2D([], [], label="two")], side=side)
        renderer, boxes = laid_out(fig)
    key_box = legend.get_window_extent(renderer)
    assert max(overlap(key_box, box) for box in boxes) < CLOSE
    assert (key_box.y0 > max(box.y0 for box in boxes)) == (side == "above")


def test_words_of_the_whole_figure_lie_beside_the_panels():
    with figure(height=60) as fig:
        fig.subplots(1, 2)
        words = fig.supxlabel("rank"), fig.supylabel("count"), fig.suptitle("Which?")
        renderer, boxes = laid_out(fig)
    for text in words:
        text_box = text.get_window_extent(renderer)
        assert max(overlap(text_box, box) for box in boxes) < CLOSE
        assert text_box.x0 > -CLOSE
        assert text_box.y1 < fig.bbox.height + CLOSE


def test_parts_of_a_figure_do_not_reach_into_each_other():
    with figure(height=50) as fig:
        for part in halves(fig, 2, 3):
            axes = part.subplots()
            axes.barh([0, 1], [3, 4])
            axes.set_yticks([0, 1], ["a long name of a row", "short"])
        _, (left, right) = laid_out(fig)
    assert overlap(left, right) < CLOSE
    assert right.x0 > 0.4 * fig.bbox.width


def test_labels_of_a_column_stand_on_one_line():
    with figure(height=80) as fig:
        grid = panels(fig)
        grid[1, 0].set_ylim(0, 123_456)  # whose ticks say more
        renderer, _ = laid_out(fig)
    edges = [axes.yaxis.label.get_window_extent(renderer).x1 for axes in grid[:, 0]]
    assert edges[0] == pytest.approx(edges[1])


def test_words_that_stick_out_of_a_panel_stay_in_the_figure():
    with figure(width=80, height=40) as fig:
        axes = fig.subplots()
        axes.set_xlim(0, 1)
        text = axes.text(1.1, 0.5, "19 of 20")
        renderer, _ = laid_out(fig)
    assert text.get_window_extent(renderer).x1 < fig.bbox.width


def test_a_word_of_a_tick_is_measured_once(monkeypatch):
    seen = []
    measure = textpath.text_to_path.get_text_width_height_descent

    def counted(word, *rest, **more):
        seen.append(word)
        return measure(word, *rest, **more)

    with figure() as fig:
        for axes in fig.subplots(3, 3).flat:
            axes.set_xlim(0, 10)
            axes.set_xticks([0, 5, 10])
        monkeypatch.setattr(textpath.text_to_path, "get_text_width_height_descent", counted)
        fig.get_layout_engine().execute(fig)
    assert seen.count("5") == 1


def test_a_figure_is_laid_out_once_and_drawn_once():
    with figure() as fig:
        fig.subplots()
        runs = []
        engine = fig.get_layout_engine()
        before = engine.execute
        engine.execute = lambda whole: (runs.append(whole), before(whole))
    assert b"<svg" in to_svg(fig)
    assert len(runs) == 1


def test_ticks_of_a_logarithm_are_powers_or_numbers_in_characters():
    assert power_of_ten(-12) == "10⁻¹²"
    assert [powers()(value) for value in (1e-3, 1.0, 0.0, -10.0)] == ["10⁻³", "10⁰", "0", "−10¹"]
    assert [numbers()(value) for value in (0.1, 10.0)] == ["0.1", "10"]


def test_a_common_factor_is_a_power_of_ten_in_characters():
    with figure() as fig:
        axes = fig.subplots()
        axes.set_xlim(0.0126, 0.0128)
        form = CommonFactor(useOffset=False)
        form.set_powerlimits((-2, 3))
        axes.xaxis.set_major_formatter(form)
        form.format_ticks([0.0126, 0.0127, 0.0128])
        assert form.get_offset() == "×10⁻²"
        axes.set_xlim(0.2, 0.8)
        form.format_ticks([0.2, 0.5, 0.8])
        assert form.get_offset() == ""


@pytest.mark.parametrize(("count", "columns"), [(1, 1), (4, 4), (15, 5), (16, 4), (18, 6)])
def test_panels_fill_their_last_row_where_they_can(count, columns):
    assert columns_of(count) == columns


def test_a_bar_is_labelled_with_the_digits_of_its_table():
    assert rounded(0.0493, 0.0480, 0.0505) == "0.0493"
    assert rounded(0.0019, 0.0014, 0.0026) == "0.0019"
    assert rounded(17.2, 5.0, 27.0) == "17"
    assert rounded(0.5, 0.5, 0.5) == "0.5"

"""The figures of the diagnosis show the stored numbers where they say they do."""

import re

import numpy as np
import pytest
from matplotlib.collections import PolyCollection
from report.diagnosis_sample import (
    acts,
    axis,
    diagnosis,
    interval,
    stored_diagnosis,
    without_gap,
)

from bayesfric.plots.diagnosis import how_far, what_acts, where_it_lies
from bayesfric.plots.labels import sizes_of
from bayesfric.plots.style import to_svg


def panel(fig, label):
    (labelled,) = [axes for axes in fig.axes if axes.get_xlabel() == label]
    return labelled


def widths(axes):
    return [bar.get_width() for bar in axes.patches if hasattr(bar, "get_width")]


def tick_texts(axes):
    return [text.get_text() for text in axes.get_yticklabels()]


SHARE = "share of the systematic force (variance)"


def test_bars_of_where_are_the_shares_with_their_intervals_and_what_is_left():
    record = stored_diagnosis().record
    fig = where_it_lies(record.where, None, unexplained=record.unexplained)
    axes = panel(fig, SHARE)
    assert tick_texts(axes) == [
        "velocity", "displacement", "tension", "number of pulleys", "order", "setup",
        "none of these",
    ]  # fmt: skip
    assert widths(axes) == pytest.approx([0.62, 0.21, 0.093, 0.021, 0.0032, 0.0, 0.0528])
    assert sum(widths(axes)) == pytest.approx(1.0)
    bar, alone = axes.lines[:2]
    share = record.where[0].share
    assert list(bar.get_xdata()) == [share.q05, share.q95]
    assert list(alone.get_xdata()) == [record.where[0].alone.q50]
    assert axes.texts[0].get_text() == "0.62"


def test_the_bar_of_the_axis_that_leads_is_another_colour_than_all_others():
    record = stored_diagnosis().record
    first, *others = panel(where_it_lies(record.where, None), SHARE).patches
    assert first.get_facecolor() not in {bar.get_facecolor() for bar in others}
    alike = tuple(axis_of_gap.model_copy(update={"leads": False}) for axis_of_gap in record.where)
    colours = {bar.get_facecolor() for bar in panel(where_it_lies(alike, None), SHARE).patches}
    assert colours == {others[0].get_facecolor()}


def test_shapes_are_the_stored_bands_of_the_four_largest():
    stored = stored_diagnosis()
    fig = where_it_lies(stored.record.where, stored.group("residuals"))
    labels = ["velocity [m/s]", "displacement [m]", "tension [N]", "number of pulleys"]
    assert [axes.get_xlabel() for axes in fig.axes][1:] == labels
    shape = stored.record.where[0].shape
    axes = panel(fig, "velocity [m/s]")
    dots, curve, zero = axes.lines
    np.testing.assert_array_equal(curve.get_xydata().T, [shape.grid, shape.gap_n])
    np.testing.assert_array_equal(dots.get_ydata(), stored.curves["residuals"]["residual_n"])
    assert list(zero.get_ydata()) == [0, 0]
    (band,) = [
        collection for collection in axes.collections if isinstance(collection, PolyCollection)
    ]
    edges = band.get_paths()[0].vertices[:, 1]
    assert (edges.min(), edges.max()) == (min(shape.low_n), max(shape.high_n))


def test_without_dots_or_shapes_the_rest_is_drawn():
    fig = where_it_lies(diagnosis().where, None)
    assert len(panel(fig, "velocity [m/s]").lines) == 2
    assert len(where_it_lies((axis("rig", "1", None),), None).axes) == 1


def test_ticks_of_many_kinds_do_not_overprint():
    first = diagnosis().where[0]
    grid = tuple(float(place) for place in range(40))
    curve = tuple(0.01 * place for place in range(40))
    shape = first.shape.model_copy(
        update={"grid": grid, "gap_n": curve, "low_n": curve, "high_n": curve}
    )
    crowded = first.model_copy(update={"axis": "setup", "unit": "1", "shape": shape})
    axes = panel(where_it_lies((crowded,), None), "setup")
    assert [text.get_text() for text in axes.get_xticklabels()] == [
        "1", "6", "11", "16", "21", "26", "31", "36",
    ]  # fmt: skip


def test_effects_are_the_most_probable_and_eight_at_most():
    likely = [acts(f"effect-{k}", 0.5 - 0.02 * k) for k in range(12)]
    left, _ = what_acts(likely, 0.02).axes
    assert tick_texts(left) == [f"effect-{k}" for k in range(8)]
    sure = what_acts((acts("viscous", 1.0, interval(0.03)), acts("slip", 0.0, None)), 0.02)
    assert [text.get_text() for text in sure.axes[0].texts] == ["> 0.999", "< 0.001"]
    rare = [acts(f"effect-{k}", 0.03 - 0.005 * k) for k in range(6)]
    left, _ = what_acts(rare, 0.02).axes  # four at least, though two are above 0.02 only
    assert widths(left) == pytest.approx([0.03, 0.025, 0.02, 0.015])


def test_bars_of_the_gap_are_the_stored_medians_in_newtons_and_millimetres():
    stored = stored_diagnosis()
    fig = how_far(stored.record.gap, 0.02, stored.group("trajectories"), named=True)
    force = panel(fig, "rms, held out: force [N]")
    systematic = stored.record.gap.systematic.q50
    assert widths(force) == [0.0951, 0.0523, 0.0187, 0.0174, systematic]
    assert widths(panel(fig, "rms, held out: trajectory [mm]")) == pytest.approx(
        [19.02, 10.46, 3.74, 3.48]
    )
    before = stored.record.gap.before
    assert list(force.lines[1].get_xdata()) == [before.q05, before.q95]
    assert tick_texts(force) == [
        "as shipped",
        "recalibrated",
        "with the effect",
        "scatter (floor)",
        "systematic gap",
    ]
    limit = force.lines[-1].get_xdata()[0]
    assert limit == pytest.approx(0.02 * stored.record.gap.friction_rms)


def test_deviations_of_trajectories_are_simulated_minus_measured():
    stored = stored_diagnosis()
    table = stored.curves["trajectories"]
    fig = how_far(stored.record.gap, 0.02, stored.group("trajectories"), named=True)
    paths, deviations = fig.axes[2:5], fig.axes[5:8]
    assert [axes.get_title() for axes in paths] == ["g0011", "g0042", "g0107"]
    _, before, after = deviations[1].lines
    assert len(before.get_xdata()) == 55  # the padding is left out
    time = table["time_s"].to_numpy()[1, :55]
    np.testing.assert_allclose(before.get_ydata(), 12.0 * time**2, rtol=1e-9)
    np.testing.assert_allclose(
        after.get_ydata(), 0.2 * np.sin(40 * 0.35 * time**2), rtol=0, atol=1e-9
    )


def test_without_cause_shipped_values_or_trajectory_their_bars_are_left_out():
    fig = how_far(without_gap().record.gap, 0.02, None, named=False)
    (axes,) = fig.axes
    assert tick_texts(axes) == ["recalibrated", "scatter (floor)", "systematic gap"]
    assert widths(axes)[:2] == [0.0176, 0.0174]
    stored = stored_diagnosis()
    alone = how_far(stored.record.gap, 0.02, stored.group("trajectories"), named=False)
    assert len(alone.axes[-1].lines) == 2  # zero and before: nothing comes after


def test_they_repeat_their_bytes():
    stored = stored_diagnosis()
    for draw in (
        lambda: where_it_lies(stored.record.where, stored.group("residuals")),
        lambda: what_acts(stored.record.inclusion, 0.02),
        lambda: how_far(stored.record.gap, 0.02, stored.group("trajectories"), named=True),
    ):
        svg = to_svg(draw())
        assert svg == to_svg(draw())
        # Clip paths are numbered: matplotlib's names hold the last bit of the layout.
        defined = re.findall(rb'<clipPath id="([^"]*)"', svg)
        assert sorted(defined) == sorted(b"clip%d" % k for k in range(len(defined)))
        assert set(re.findall(rb"url\(#([^)]*)\)", svg)) - set(defined) <= set(
            re.findall(rb'<pattern id="([^"]*)"', svg)
        )


def test_kinds_are_points_with_bars_and_no_line_between_them():
    kinds = axis("pulley_size", "1", 0.4, 0.0, 2.0)
    shape = kinds.shape.model_copy(
        update={
            "grid": (0.0, 1.0, 2.0),
            "gap_n": (0.0, 0.1, -0.1),
            "low_n": (-0.1, 0.0, -0.2),
            "high_n": (0.1, 0.2, 0.0),
        }
    )
    axes = panel(where_it_lies((kinds.model_copy(update={"shape": shape}),), None), "pulley size")
    assert [text.get_text() for text in axes.get_xticklabels()] == ["1", "2", "3"]
    named = where_it_lies(
        (kinds.model_copy(update={"shape": shape}),), None, "N",
        sizes_of(["c1[small]", "c2[small]", "c1[my own]", "c1[large]"]),
    )  # fmt: skip
    ticks = panel(named, "pulley size").get_xticklabels()
    assert [text.get_text() for text in ticks] == ["small", "my own", "large"]
    points = axes.lines[0]
    assert (points.get_linestyle(), points.get_marker()) == ("None", "o")
    assert list(points.get_ydata()) == [0.0, 0.1, -0.1]


def test_what_acts_shows_probability_and_strength():
    strong = acts("viscous", 0.97, interval(0.05))
    left, right = what_acts([strong, acts("slip", 0.3)], 0.02).axes
    assert widths(left) == [0.97, 0.3]
    assert tick_texts(left) == ["viscous", "slip"]
    bar, middle, practical = right.lines
    ends = [100 * strong.strength.q05, 100 * strong.strength.q95]
    assert list(bar.get_xdata()) == pytest.approx(ends)
    assert middle.get_xdata()[0] == pytest.approx(5.0)
    assert practical.get_xdata()[0] == pytest.approx(2.0)

"""Figures show the stored numbers where they say they do."""

from itertools import pairwise

import numpy as np
import pytest
import xarray as xr
from matplotlib.collections import LineCollection

from bayesfric.plots.assemblies import assemblies_left_out
from bayesfric.plots.labels import ordered_sizes, parameter_label, plain
from bayesfric.plots.posterior import coefficient_pairs, coefficients_relative_to_paper
from bayesfric.plots.ranks import rank_histograms
from bayesfric.plots.style import COLORS, NEUTRAL, size_styles, to_svg
from bayesfric.plots.tension import friction_against_tension
from bayesfric.plots.trajectories import measured_and_predicted


def legend_texts(fig):
    return [text.get_text() for legend in fig.legends for text in legend.get_texts()]


def horizontal_lines(axes):
    return [line for line in axes.lines if len(line.get_ydata()) == 2]


def test_ratio_bars_end_at_the_stored_quantiles(small_fit):
    table = small_fit.predictive["coefficients"]
    (axes,) = coefficients_relative_to_paper(small_fit.predictive).axes
    labels = [text.get_text() for text in axes.get_yticklabels()]
    assert labels[:4] == ["$c_1$ small", "$c_1$ medium", "$c_1$ large", "$c_2$ small"]
    row = axes.get_yticks()[labels.index("$c_3$ medium")]
    bars = [line for line in horizontal_lines(axes) if list(line.get_ydata()) == [row, row]]
    ratio = table["ratio"].sel(coefficient="c3", pulley="medium").to_numpy()
    assert [list(bar.get_xdata()) for bar in bars] == [list(ratio[[0, 4]]), list(ratio[[1, 3]])]
    assert ratio == pytest.approx(
        table["value"].sel(coefficient="c3", pulley="medium").to_numpy() / 1.02e-5
    )


def test_a_refit_has_the_colours_and_the_law_alone_is_grey(small_fit):
    refitted = {"c2[small]": (0.0250, 0.0261, 0.0270)}
    (axes,) = coefficients_relative_to_paper(small_fit.predictive, (), refitted).axes
    labels = [text.get_text() for text in axes.get_yticklabels()]
    row = axes.get_yticks()[labels.index("$c_2$ small")]
    bars = {line.get_ydata()[0]: line for line in horizontal_lines(axes)}
    styles = size_styles(["small", "medium", "large"])
    refit = bars[row - 0.35]
    assert list(refit.get_xdata()) == pytest.approx([0.0250 / 0.0261, 0.0270 / 0.0261])
    assert (refit.get_color(), bars[row].get_color()) == (styles["small"].color, NEUTRAL)
    alone = bars[axes.get_yticks()[labels.index("$c_2$ large")]]
    assert alone.get_color() == styles["large"].color


def test_table_1_is_marked_in_the_pairs(small_fit):
    paper = {"c1": 0.00416, "c2": 0.0165, "c3": 1.02e-5}
    fig = coefficient_pairs(small_fit.draws, "medium", paper)
    shown = [axes for axes in fig.axes if axes.lines]
    (mark,) = {float(line.get_xdata()[0]) for line in shown[0].lines}
    assert mark == pytest.approx(4.16)  # in thousandths, as the axis says
    assert fig.axes[-1].get_xlabel() == "$c_3$ [10⁻⁶ deg⁻¹]"
    assert "paper" in legend_texts(fig)
    bare = coefficient_pairs(small_fit.draws, "medium", None)
    assert not [line for axes in bare.axes for line in axes.lines]
    assert "paper" not in legend_texts(bare)


def test_labels_of_the_pairs_do_not_overprint(small_fit):
    """Three low panels stand above each other, each with a name and a long unit."""
    fig = coefficient_pairs(small_fit.draws, "medium", None)
    fig.canvas.draw()
    labels = [axes.yaxis.label for axes in fig.axes if axes.get_ylabel() and axes.axison]
    boxes = [label.get_window_extent() for label in labels if label.get_visible()]
    boxes = sorted(boxes, key=lambda box: box.y0)
    assert len(boxes) >= 2
    assert all(low.y1 <= high.y0 or low.x1 <= high.x0 for low, high in pairwise(boxes))


def test_table_1_far_from_the_draws_is_named_and_does_not_squeeze_them(small_fit):
    near = coefficient_pairs(small_fit.draws, "medium", None)
    fig = coefficient_pairs(small_fit.draws, "medium", {"c1": 0.4, "c2": 0.0165, "c3": 1.02e-5})
    assert "paper beyond the panel: $c_1$ = 400" in legend_texts(fig)
    assert fig.axes[0].get_xlim() == near.axes[0].get_xlim()
    assert not fig.axes[0].lines


def test_of_two_coefficients_the_one_far_from_the_draws_is_named(small_fit):
    two = xr.DataTree(small_fit.draws["posterior"].to_dataset().drop_vars("c3"))
    draws = xr.DataTree(children={"posterior": two})
    fig = coefficient_pairs(draws, "medium", {"c1": 0.4, "c2": 0.0165, "c3": 1.02e-5})
    assert "paper beyond the panel: $c_1$ = 400" in legend_texts(fig)
    assert not any("c_3" in text for text in legend_texts(fig))


def test_a_row_that_the_data_do_not_inform_says_so(small_fit):
    (axes,) = coefficients_relative_to_paper(small_fit.predictive, ["c3[small]"]).axes
    labels = [text.get_text() for text in axes.get_yticklabels()]
    row = axes.get_yticks()[labels.index("$c_3$ small")]
    assert not [line for line in horizontal_lines(axes) if list(line.get_ydata()) == [row, row]]
    (said,) = axes.texts
    assert said.get_position() == (1.0, row)
    assert "not informed" in said.get_text()


def test_bands_of_trajectories_are_the_stored_ones(small_fit):
    table = small_fit.predictive["trajectories"]
    fig = measured_and_predicted(small_fit.predictive)
    assert len(fig.axes) == 2 * table.sizes["shown"]
    sizes = table["pulley_size"].to_numpy()
    ends = np.nanmax(table["time_s"].to_numpy(), axis=1)
    (place,) = np.flatnonzero((sizes == "small") & (ends == ends[sizes == "small"].min()))
    trial = table.isel(shown=place)  # the fast one of the small size is on top
    seen = np.isfinite(trial["time_s"].to_numpy())
    travel = [line for line in fig.axes[0].lines if line.get_linestyle() == "None"]
    assert travel[0].get_ydata() == pytest.approx(trial["travel_m"].to_numpy()[seen])
    vertices = fig.axes[0].collections[0].get_paths()[0].vertices[:, 1]
    assert vertices.max() == pytest.approx(np.nanmax(trial["predicted_m"].isel(quantile=2)))
    assert f"n = {trial['n_pulleys'].item()}" in fig.axes[0].get_title()


def test_friction_points_and_table_1_lines(small_fit):
    trials = small_fit.predictive["trials"]
    fig = friction_against_tension(small_fit.predictive, 85.0)
    panels = {axes.get_title(): axes for axes in fig.axes[:3]}
    assert list(panels) == ["small", "medium", "large"]
    chosen = (trials["pulley_size"] == "large") & (trials["wrap_angle_deg"] == 85.0)
    points = [line for line in panels["large"].lines if line.get_linestyle() == "None"]
    shown = np.sort(np.concatenate([line.get_ydata() for line in points]))
    assert shown == pytest.approx(np.sort(trials["friction_n"].to_numpy()[chosen.to_numpy()]))
    (dashed,) = [line for line in panels["large"].lines if line.get_color() == COLORS["black"]]
    # Table I, large, n = 9, at the top tension: 9 (0.00239 T + 0.0129).
    top = dashed.get_xdata()[-1]
    assert dashed.get_ydata()[-1] == pytest.approx(9 * (0.00239 * top + 0.0129))


def test_friction_below_is_relative_to_the_median_of_the_law(small_fit):
    trials = small_fit.predictive["trials"].to_dataset()
    chosen = (trials["pulley_size"] == "large") & (trials["wrap_angle_deg"] == 85.0)
    trials = trials.isel(trial=np.flatnonzero(chosen))
    below = friction_against_tension(small_fit.predictive, 85.0).axes[5]
    law = trials["law_n"].to_numpy()[:, 1]
    points = [line for line in below.lines if line.get_linestyle() == "None"]
    shown = np.sort(np.concatenate([line.get_ydata() for line in points]))
    assert shown == pytest.approx(np.sort(100 * (trials["friction_n"].to_numpy() / law - 1)))
    (bars,) = [
        collection for collection in below.collections if isinstance(collection, LineCollection)
    ]
    ends = np.sort([segment[:, 1] for segment in bars.get_segments()], axis=0)
    predicted = 100 * (trials["predicted_n"].to_numpy()[:, [0, 2]] / law[:, None] - 1)
    assert ends == pytest.approx(np.sort(predicted, axis=0))


def test_table_1_is_in_no_legend_of_a_size_that_the_paper_lacks(small_fit):
    predictive = small_fit.predictive.copy()
    curves = predictive["curves"].to_dataset()
    predictive["curves"] = xr.DataTree(curves.assign(paper_n=curves["paper_n"] * np.nan))
    assert "paper's law" in legend_texts(friction_against_tension(small_fit.predictive, 85.0))
    assert "paper's law" not in legend_texts(friction_against_tension(predictive, 85.0))


def test_rank_counts_are_relative_to_those_expected(small_fit):
    table = small_fit.predictive["ranks"]
    fig = rank_histograms(small_fit.predictive)
    visible = [axes for axes in fig.axes if axes.get_visible()]
    assert len(visible) == table.sizes["parameter"]
    heights = visible[0].patches[0].get_data().values
    assert heights == pytest.approx(table["relative"].isel(parameter=0, ensemble=0).to_numpy())
    assert heights.mean() == pytest.approx(1.0)


def test_figures_are_small_and_take_any_name(small_fit):
    hostile = "a$b_c{小}\\frac" + 40 * "x"
    predictive = small_fit.predictive.copy()
    for group in ("trials", "curves", "trajectories"):
        data = predictive[group].to_dataset()
        names = np.where(data["pulley_size"] == "large", hostile, data["pulley_size"])
        data["pulley_size"] = (data["pulley_size"].dims, names)
        predictive[group] = xr.DataTree(data)
    for fig in (
        friction_against_tension(predictive, 85.0),
        measured_and_predicted(predictive),
        rank_histograms(predictive),
        coefficient_pairs(small_fit.draws, "medium", None),
    ):
        svg = to_svg(fig)
        assert len(svg) < 300_000


def test_names_hold_no_markup():
    assert parameter_label("c1[small]") == "$c_1$ small"
    assert parameter_label("tau") == "$τ$"
    assert parameter_label("tau[$x$]") == r"$τ$ \$x\$"
    assert plain("小") == "[U+5C0F]"
    assert len(plain(100 * "x")) == 24
    assert ordered_sizes(["mine", "large", "small", "mine"]) == ["small", "large", "mine"]


def test_a_size_of_the_users_own_looks_like_no_other():
    looks = size_styles(["small", "medium", "large", "lab", "bench"])
    assert len({(look.color, look.marker) for look in looks.values()}) == 5


def test_assemblies_stand_at_their_scores_over_their_rank_and_condition():
    """Of three made-up assemblies, one of them far out and named."""
    table = xr.Dataset(
        {
            "z": ("assembly", [-0.5, 0.2, 3.4]),
            "expected": (("assembly", "quantile"), [[-2, -0.8, 0.1], [-1, 0, 1], [-0.1, 0.8, 2]]),
            "far": 3.0,
            "pit_difference": ("probability", [0.1, -0.1]),
            "pit_band": (("end", "probability"), [[-0.4, -0.4], [0.4, 0.4]]),
            "pulley_size": ("assembly", ["large", "small", "small"]),
            "n_pulleys": ("assembly", [9, 9, 5]),
            "wrap_angle_deg": ("assembly", [85.0, 85.0, 135.0]),
        },
        coords={"assembly": ["s1", "s2", "s3"], "probability": [0.3, 0.6]},
    )
    words = {"rig": "gravity", "title": "gravity board", "trial": "trial", "trials": "trials"}
    trials = xr.Dataset(attrs={**words, "id": "trial"})
    tree = xr.DataTree.from_dict({"trials": trials, "trial_assemblies": table})
    distribution, ranked, by_condition = assemblies_left_out(tree).axes
    assert distribution.lines[-1].get_ydata().tolist() == [0.1, -0.1]
    assert ranked.lines[-1].get_xydata().tolist() == [[-0.8, -0.5], [0.0, 0.2], [0.8, 3.4]]
    cells = [text.get_text() for text in by_condition.get_xticklabels()]
    assert cells == ["small 5, 135", "small 9, 85", "large 9, 85"]
    points = {tuple(p) for line in by_condition.lines[2:] for p in line.get_xydata().tolist()}
    assert points == {(0.0, 3.4), (1.0, 0.2), (2.0, -0.5)}
    assert [text.get_text() for text in by_condition.texts] == ["s3"]
    checks = xr.Dataset(
        {
            "score": ("rank", [-1.1, 0.7]),
            "score_expected": (("rank", "quantile"), [[-2.0, -0.6, 0.0], [0.0, 0.6, 2.0]]),
        }
    )
    tree["trial_checks"] = xr.DataTree(checks)
    _, _, of_trials, _ = assemblies_left_out(tree).axes
    assert of_trials.lines[-1].get_xydata().tolist() == [[-0.6, -1.1], [0.6, 0.7]]
    assert of_trials.get_ylabel() == "score of\na trial"
    assert by_condition.get_ylabel() == "score of\none assembly"
    tree["trials"].attrs["group"] = "setup"  # as a rig without assemblies calls it
    labels = [axes.get_ylabel() for axes in assemblies_left_out(tree).axes]
    assert [labels[1], labels[3]] == ["score of\none setup"] * 2
    # Of one condition they would all lie in one place: they stand in their order.
    alone = table.drop_vars(["pulley_size", "n_pulleys", "wrap_angle_deg"])
    tree["trial_assemblies"] = xr.DataTree(alone)
    axes = assemblies_left_out(tree).axes[-1]
    assert axes.lines[-1].get_xydata().tolist() == [[0, -0.5], [1, 0.2], [2, 3.4]]
    assert [text.get_text() for text in axes.get_xticklabels()] == ["s1", "s2", "s3"]
    assert axes.get_title() == "gravity board: in their order"

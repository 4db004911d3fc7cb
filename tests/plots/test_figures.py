"""Figures show the stored numbers where they say they do."""

import numpy as np
import pytest

from bayesfric.plots.posterior import coefficient_pairs, coefficients_relative_to_paper
from bayesfric.plots.ranks import rank_histograms
from bayesfric.plots.style import size_styles
from bayesfric.plots.tension import friction_against_tension
from bayesfric.plots.trajectories import measured_and_predicted


def horizontal_lines(axes):
    return [line for line in axes.lines if len(line.get_ydata()) == 2]


def test_ratio_bars_end_at_the_stored_quantiles(small_fit):
    table = small_fit.predictive["coefficients"]
    (axes,) = coefficients_relative_to_paper(small_fit.predictive).axes
    labels = [text.get_text() for text in axes.get_yticklabels()]
    assert labels[:4] == ["c1 small", "c1 medium", "c1 large", "c2 small"]
    row = axes.get_yticks()[labels.index("c3 medium")]
    bars = [line for line in horizontal_lines(axes) if list(line.get_ydata()) == [row, row]]
    ratio = table["ratio"].sel(coefficient="c3", pulley="medium").to_numpy()
    assert [list(bar.get_xdata()) for bar in bars] == [list(ratio[[0, 4]]), list(ratio[[1, 3]])]
    assert ratio == pytest.approx(
        table["value"].sel(coefficient="c3", pulley="medium").to_numpy() / 1.02e-5
    )


def test_table_1_is_marked_in_the_pairs(small_fit):
    paper = {"c1": 0.00416, "c2": 0.0165, "c3": 1.02e-5}
    fig = coefficient_pairs(small_fit.draws, "medium", paper)
    shown = [axes for axes in fig.axes if axes.lines]
    (mark,) = {float(line.get_xdata()[0]) for line in shown[0].lines}
    assert mark == pytest.approx(4.16)  # in thousandths, as the axis says
    assert fig.axes[-1].get_xlabel() == "c3 [10⁻⁶/deg]"
    bare = coefficient_pairs(small_fit.draws, "medium", None)
    assert not [line for axes in bare.axes for line in axes.lines]


def test_bands_of_trajectories_are_the_stored_ones(small_fit):
    table = small_fit.predictive["trajectories"]
    fig = measured_and_predicted(small_fit.predictive)
    assert len(fig.axes) == 2 * table.sizes["shown"]
    trial = table.isel(shown=0)
    seen = np.isfinite(trial["time_s"].to_numpy())
    travel = [line for line in fig.axes[0].lines if line.get_linestyle() == "None"]
    assert travel[0].get_ydata() == pytest.approx(trial["travel_m"].to_numpy()[seen])
    vertices = fig.axes[0].collections[0].get_paths()[0].vertices[:, 1]
    assert vertices.max() == pytest.approx(np.nanmax(trial["predicted_m"].isel(quantile=2)))
    assert f"n = {trial['n_pulleys'].item()}" in fig.axes[0].get_title()


def test_friction_points_and_table_1_lines(small_fit):
    trials = small_fit.predictive["trials"]
    fig = friction_against_tension(small_fit.predictive, 85.0)
    panels = {axes.get_title(): axes for axes in fig.axes}
    assert list(panels) == ["small", "medium", "large"]
    chosen = (trials["pulley_size"] == "large") & (trials["wrap_angle_deg"] == 85.0)
    points = [line for line in panels["large"].lines if line.get_linestyle() == "None"]
    shown = np.sort(np.concatenate([line.get_ydata() for line in points]))
    assert shown == pytest.approx(np.sort(trials["friction_n"].to_numpy()[chosen.to_numpy()]))
    (dashed,) = [line for line in panels["large"].lines if line.get_linestyle() == "--"]
    # Table I, large, n = 9, at the top tension: 9 (0.00239 T + 0.0129).
    top = dashed.get_xdata()[-1]
    assert dashed.get_ydata()[-1] == pytest.approx(9 * (0.00239 * top + 0.0129))


def test_rank_counts_are_relative_to_those_expected(small_fit):
    table = small_fit.predictive["ranks"]
    fig = rank_histograms(small_fit.predictive)
    visible = [axes for axes in fig.axes if axes.get_visible()]
    assert len(visible) == table.sizes["parameter"]
    heights = visible[0].patches[0].get_data().values
    assert heights == pytest.approx(table["relative"].isel(parameter=0, ensemble=0).to_numpy())
    assert heights.mean() == pytest.approx(1.0)


def test_a_size_of_the_users_own_looks_like_no_other():
    looks = size_styles(["small", "medium", "large", "lab", "bench"])
    assert len({(look.color, look.marker) for look in looks.values()}) == 5

"""The paper's figures of slopes, residuals and densities show the stored numbers."""

import numpy as np
import pytest
import xarray as xr
from matplotlib.collections import LineCollection

from bayesfric.plots.densities import prior_and_posterior
from bayesfric.plots.residuals_by_order import residuals_by_order
from bayesfric.plots.slopes import friction_against_wrap, line_against_pulleys, wrap_slopes
from bayesfric.plots.style import COLORS, to_svg


def points(axes):
    """What is drawn by markers alone, as rows of x and y."""
    drawn = [line.get_xydata() for line in axes.lines if line.get_linestyle() == "None"]
    return np.concatenate([xy for xy in drawn if len(xy)])


def bars(axes):
    """Ends of the vertical bars, as rows of x, lower and upper end."""
    collections = [c for c in axes.collections if isinstance(c, LineCollection)]
    segments = [segment for collection in collections for segment in collection.get_segments()]
    return np.array([(segment[0, 0], *np.sort(segment[:, 1])) for segment in segments])


def in_order(rows):
    rows = np.asarray(rows)
    return rows[np.lexsort(rows.T)]


def band_top(axes, place=0):
    bands = [c for c in axes.collections if not isinstance(c, LineCollection)]
    return bands[place].get_paths()[0].vertices[:, 1].max()


@pytest.fixture
def predictive(wrap_fit):
    return wrap_fit.predictive


def test_slopes_and_intercepts_over_the_number_of_pulleys(predictive):
    table = predictive["tension_lines"].to_dataset()
    fig = line_against_pulleys(predictive)
    chosen = (table["pulley_size"] == "medium") & table["upright"]
    cells = table.isel(cell=np.flatnonzero(chosen))
    n = cells["n_pulleys"].to_numpy()
    for axes, name, unit in ((fig.axes[1], "slope", ""), (fig.axes[4], "intercept", "_n")):
        value = 1e3 * cells[f"{name}{unit}"].to_numpy()
        again = 1e3 * cells[f"{name}_again{unit}"].to_numpy()
        assert in_order(points(axes)) == pytest.approx(in_order(np.column_stack([n, value])))
        expected = np.column_stack([n, again[:, 0], again[:, 2]])
        assert in_order(bars(axes)) == pytest.approx(in_order(expected))
        law = 1e3 * table[f"{name}_law{unit}"].sel(pulley="medium").to_numpy()
        assert band_top(axes) == pytest.approx(law[-1, 2])
    (printed,) = [line for line in fig.axes[1].lines if line.get_color() == COLORS["black"]]
    assert printed.get_ydata()[-1] == pytest.approx(1e3 * 0.00416 * 15)


def test_table_1_is_in_no_legend_of_a_size_that_the_paper_lacks(predictive):
    def said(tree):
        return [t.get_text() for t in line_against_pulleys(tree).legends[0].get_texts()]

    bare = predictive.copy()
    table = bare["tension_lines"].to_dataset()
    lacking = {name: table[name] * np.nan for name in ("slope_paper", "intercept_paper_n")}
    bare["tension_lines"] = xr.DataTree(table.assign(lacking))
    assert "paper's law" in said(predictive)
    assert "paper's law" not in said(bare)


def test_friction_against_wrap_has_a_row_for_each_number_of_pulleys(predictive):
    table = predictive["wrap_lines"].to_dataset()
    fig = friction_against_wrap(predictive)
    assert [axes.get_title() for axes in fig.axes] == ["small", "medium", "large", "", "", ""]
    assert [axes.get_ylabel() for axes in fig.axes[::3]] == [
        "n = 9\nfriction [N]",
        "n = 15\nfriction [N]",
    ]
    chosen = (table["pulley_size"] == "large") & (table["n_pulleys"] == 9)
    some = table.isel(line=np.flatnonzero(chosen))
    angle = some["wrap_angle_deg"].to_numpy().ravel()
    expected = np.column_stack([angle, some["friction_n"].to_numpy().ravel()])
    assert in_order(points(fig.axes[2])) == pytest.approx(in_order(expected))
    again = some["friction_again_n"].to_numpy()
    expected = np.column_stack([angle, again[..., 0].ravel(), again[..., 2].ravel()])
    assert in_order(bars(fig.axes[2])) == pytest.approx(in_order(expected))
    assert band_top(fig.axes[2], 2) == pytest.approx(some["law_n"].to_numpy()[2, :, 2].max())
    markers = {line.get_marker() for line in fig.axes[2].lines if line.get_linestyle() == "None"}
    assert len(markers) == 3  # tensions are told apart without colour


def test_wrap_slopes_over_pulleys_and_over_tension(predictive):
    table = predictive["wrap_lines"].to_dataset()
    fig = wrap_slopes(predictive)
    some = table.isel(line=np.flatnonzero(table["pulley_size"] == "small"))
    slope = 1e3 * some["slope_n_per_deg"].to_numpy()
    again = 1e3 * some["slope_again_n_per_deg"].to_numpy()
    for axes, across, law in (
        (fig.axes[0], "n_pulleys", table["law_against_n"].sel(pulley="small")),
        (fig.axes[3], "tension_n", table["law_against_tension"].sel(pulley="small")),
    ):
        x = some[across].to_numpy()
        assert in_order(points(axes)) == pytest.approx(in_order(np.column_stack([x, slope])))
        expected = np.column_stack([x, again[:, 0], again[:, 2]])
        assert in_order(bars(axes)) == pytest.approx(in_order(expected))
        assert band_top(axes, -1) == pytest.approx(1e3 * law.to_numpy()[-1, -1, 2])
        assert axes.get_xlim()[0] == 0
    texts = [text.get_text() for text in fig.axes[3].get_legend().get_texts()]
    assert texts == ["n = 9", "n = 15"]


def test_residuals_stand_in_the_order_of_measuring(predictive):
    fig = residuals_by_order(predictive)
    assert [axes.get_title() for axes in fig.axes] == ["gravity board, trials", "motor board, runs"]
    for axes, group in zip(fig.axes, ("trials", "runs"), strict=True):
        table = predictive[group].to_dataset()
        expected = np.column_stack([table["order"].to_numpy(), table["z"].to_numpy()])
        assert in_order(points(axes)) == pytest.approx(in_order(expected))
        limit = float(table["z_limit"])
        heights = [line.get_ydata()[0] for line in axes.lines if line.get_linestyle() == ":"]
        assert heights == pytest.approx([-limit, limit])
        assert not axes.texts


def test_trials_without_an_order_stand_side_by_side(predictive):
    tree = predictive.copy()
    table = tree["trials"].to_dataset()
    tree["trials"] = xr.DataTree(table.assign(order=0 * table["order"] + 1))
    places = np.sort(points(residuals_by_order(tree).axes[0])[:, 0])
    assert places == pytest.approx(np.arange(1, table.sizes["trial"] + 1))


def test_outliers_are_named_up_to_a_few(predictive):
    def said(count):
        tree = predictive.copy()
        table = tree["trials"].to_dataset()
        far = np.arange(table.sizes["trial"]) < count
        tree["trials"] = xr.DataTree(table.assign(outlier=("trial", far)))
        return [text.get_text() for text in residuals_by_order(tree).axes[0].texts]

    assert said(2) == [str(name) for name in predictive["trials"]["trial"].to_numpy()[:2]]
    assert said(7) == []


def test_densities_of_each_parameter(predictive):
    table = predictive["densities"].to_dataset()
    fig = prior_and_posterior(predictive)
    visible = [axes for axes in fig.axes if axes.get_visible()]
    assert len(visible) == table.sizes["parameter"]
    assert visible[0].get_title() == "$c_1$ small"
    assert "[N]" in visible[3].get_title()
    for place, axes in enumerate(visible):
        entry = table.isel(parameter=place)
        assert axes.get_yscale() == "log"
        heights = axes.patches[0].get_data()
        assert heights.values == pytest.approx(entry["posterior"].to_numpy())
        assert heights.edges == pytest.approx(entry["value"].to_numpy())
        assert axes.lines[0].get_ydata() == pytest.approx(entry["prior"].to_numpy())
        low, high = axes.get_ylim()
        assert low < entry["prior"].to_numpy().min()
        assert entry["posterior"].to_numpy().max() < high


def test_a_prior_that_is_nothing_where_the_draws_are_runs_out_of_its_panel(predictive):
    """Forty scales out its density is 1e-321, over which no axis of powers of ten goes."""
    tree = predictive.copy()
    table = tree["densities"].to_dataset()
    tree["densities"] = xr.DataTree(table.assign(prior=0 * table["prior"] + 1.4e-321))
    for axes in prior_and_posterior(tree).axes[: table.sizes["parameter"]]:
        low, high = axes.get_ylim()
        assert 0 < high < 1e10 * low


def test_figures_are_small_and_take_any_name(predictive):
    hostile = "a$b_c{小}\\frac" + 40 * "x"

    def named(values):
        return np.where(values == "large", hostile, values)

    tree = predictive.copy()
    for group in ("trials", "runs", "tension_lines", "wrap_lines"):
        data = tree[group].to_dataset()
        data["pulley_size"] = (data["pulley_size"].dims, named(data["pulley_size"].to_numpy()))
        if "pulley" in data.coords:
            data = data.assign_coords(pulley=named(data["pulley"].to_numpy()))
        tree[group] = xr.DataTree(data)
    for draw in (
        line_against_pulleys,
        friction_against_wrap,
        wrap_slopes,
        residuals_by_order,
        prior_and_posterior,
    ):
        assert len(to_svg(draw(tree))) < 400_000

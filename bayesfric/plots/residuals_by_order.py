"""Each trial against what a new trial is predicted to do, in the order of measuring."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from bayesfric.plots.labels import ordered_sizes, plain
from bayesfric.plots.live import Band, Chart, Curve, clouds_by_size, trial_words
from bayesfric.plots.rig_tables import RigTable, rig_tables
from bayesfric.plots.style import (
    COLORS,
    NEUTRAL,
    NORMAL_90,
    SizeStyle,
    area_key,
    figure,
    hollow,
    key,
    line_key,
    size_styles,
)

NAMED = 6  # outliers that carry their id; more would hide the points
LINE = 0.9


def residuals_by_order(predictive: xr.DataTree) -> Figure:
    """Draw the z of each trial in the order of measuring, a panel a rig.

    Parameters
    ----------
    predictive : DataTree
        ``predictive.nc``.

    Returns
    -------
    Figure
        A point a trial by size, the 90 % interval of new trials shaded, the limit of
        outliers dotted; outliers are ringed and named.
    """
    tables = rig_tables(predictive)
    names = [name for rig in tables for name in rig.sizes]
    styles = size_styles(ordered_sizes(names))
    with figure(height=10.0 + 40.0 * len(tables)) as fig:
        panels = fig.subplots(len(tables), squeeze=False)[:, 0]
        for axes, rig in zip(panels, tables, strict=True):
            _draw(axes, rig, styles)
            axes.set_title(f"{plain(rig.title)}, {plain(rig.trials)}")
            axes.set_ylabel("z of friction")
            axes.xaxis.set_major_locator(MaxNLocator(integer=True))
        panels[-1].set_xlabel("order of measuring")
        keys = [
            line_key(plain(size), marker=look.marker, linestyle="", **hollow(look.color, 3.4))
            for size, look in styles.items()
        ]
        keys.append(area_key("90 % of new trials", 0.3))
        dotted = {"color": COLORS["black"], "linewidth": LINE, "linestyle": ":"}
        keys.append(line_key("outliers lie beyond", **dotted))
        key(fig, keys, ncols=len(keys))
        return fig


def residual_charts(predictive: xr.DataTree, unit: str) -> list[Chart]:
    """Return the z of each trial in the order of measuring, a chart a rig.

    Parameters
    ----------
    predictive : DataTree
        ``predictive.nc``.
    unit : str
        Of friction.
    """
    charts = []
    for rig in rig_tables(predictive):
        columns, words = trial_words(rig, unit)
        order, z = _order(rig), rig.table["z"].to_numpy()
        ends = np.array([order.min() - 1, order.max() + 1])
        level = np.ones(2)
        limit = float(rig.table["z_limit"])
        charts.append(
            Chart(
                title=f"{rig.title}, {rig.trials}",
                x_label="order of measuring",
                y_label="z of friction",
                columns=columns,
                clouds=clouds_by_size(rig, size_styles(ordered_sizes(rig.sizes)), order, z, words),
                curves=[
                    Curve("", COLORS["black"], ends, sign * limit * level, dashed=True)
                    for sign in (-1, 1)
                ],
                bands=[Band("", NEUTRAL, ends, -NORMAL_90 * level, NORMAL_90 * level)],
            )
        )
    return charts


def _order(rig: RigTable) -> NDArray[np.float64]:
    """Return the order of measuring; that of the table where all trials have the same one."""
    order = np.asarray(rig.table["order"].to_numpy(), dtype=np.float64)
    return np.arange(1.0, order.size + 1) if np.ptp(order) == 0 else order


def _draw(axes: Axes, rig: RigTable, styles: dict[str, SizeStyle]) -> None:
    table = rig.table
    axes.axhspan(-NORMAL_90, NORMAL_90, color=NEUTRAL, alpha=0.15, linewidth=0)
    for sign in (-1, 1):
        limit = sign * float(table["z_limit"])
        axes.axhline(limit, color=COLORS["black"], linewidth=LINE, linestyle=":")
    sizes = np.array(rig.sizes)
    order, z = _order(rig), table["z"].to_numpy()
    for size, look in styles.items():
        axes.plot(
            order[sizes == size],
            z[sizes == size],
            look.marker,
            **hollow(look.color, 3.0, markeredgewidth=0.7),
        )
    far = np.flatnonzero(table["outlier"].to_numpy())
    axes.plot(
        order[far],
        z[far],
        "o",
        markersize=8,
        markeredgecolor=COLORS["black"],
        markerfacecolor="none",
    )
    for place in far if len(far) <= NAMED else ():
        name = plain(str(table[rig.id].to_numpy()[place]))
        axes.annotate(name, (order[place], z[place]), (5, 3), textcoords="offset points")

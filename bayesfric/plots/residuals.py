"""Each trial against what a new trial is predicted to do, in the order of measuring."""

from typing import Literal

import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from bayesfric.plots.labels import ordered_sizes, plain
from bayesfric.plots.style import COLORS, NEUTRAL, figure, size_styles

__all__ = ["residuals_by_order"]

NORMAL_90 = 1.6449
"""Half the width of a standard normal's 90 % interval, the unit of the stored z."""

NAMED = 6  # outliers that carry their id; more would hide the points


def residuals_by_order(predictive: xr.DataTree, group: Literal["trials", "runs"]) -> Figure:
    """Draw the z of each trial in the order of measuring.

    Parameters
    ----------
    predictive : DataTree
        ``predictive.nc`` with that group.
    group : {"trials", "runs"}
        Of the gravity board or of the motor board.

    Returns
    -------
    Figure
        A point a trial by size, the 90 % interval of new trials shaded, the limit of
        outliers dotted; outliers are ringed and named.
    """
    table = predictive[group].to_dataset()
    sizes = ordered_sizes(table["pulley_size"].to_numpy())
    styles = size_styles(sizes)
    limit = float(table["z_limit"])
    with figure(height=62.0) as fig:
        axes = fig.subplots()
        axes.axhspan(-NORMAL_90, NORMAL_90, color=NEUTRAL, alpha=0.15, linewidth=0)
        for sign in (-1, 1):
            axes.axhline(sign * limit, color=COLORS["black"], linewidth=0.9, linestyle=":")
        for size in sizes:
            here = (table["pulley_size"] == size).to_numpy()
            look = styles[size]
            axes.plot(
                table["order"].to_numpy()[here],
                table["z"].to_numpy()[here],
                look.marker,
                color="white",
                markersize=3.0,
                markeredgewidth=0.7,
                markeredgecolor=look.color,
                label=plain(size),
            )
        far = table.isel({_dimension(group): table["outlier"].to_numpy().astype(bool)})
        axes.plot(far["order"], far["z"], "o", color="none", markersize=8, markeredgecolor="black")
        names = far[_dimension(group)].to_numpy()
        if len(names) <= NAMED:
            for name, place, z in zip(names, far["order"], far["z"], strict=True):
                axes.annotate(
                    plain(str(name)), (float(place), float(z)), (5, 3), textcoords="offset points"
                )
        axes.set_xlabel("order of measuring")
        axes.set_ylabel("z of friction")
        keys: list[Line2D | Patch] = [
            *(line for line in axes.get_lines() if str(line.get_label()) in map(plain, sizes)),
            Patch(color=NEUTRAL, alpha=0.3, linewidth=0, label="90 % of new trials"),
            Line2D(
                [], [], color=COLORS["black"], linewidth=0.9, linestyle=":", label="outliers beyond"
            ),
        ]
        fig.legend(handles=keys, loc="outside lower center", ncols=len(keys))
        return fig


def _dimension(group: str) -> str:
    return group.removesuffix("s")

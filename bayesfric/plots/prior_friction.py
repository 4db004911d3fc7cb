"""Friction that the priors alone imply, beside the posterior and what was measured."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bayesfric.plots.labels import ordered_sizes, plain, powers
from bayesfric.plots.style import COLORS, NEUTRAL, area_key, figure, key, line_key

LEAST_FRICTION_N = 0.05  # of an axis that has room for frictions down to zero [N]


def friction_of_priors(predictive: xr.DataTree) -> Figure:
    """Draw friction of each condition by prior and posterior, a panel a size.

    Parameters
    ----------
    predictive : DataTree
        ``predictive.nc`` with its group ``prior``.

    Returns
    -------
    Figure
        Conditions in the order of measured friction, on an axis that is logarithmic above
        the least friction measured and linear below: bands of the prior, the posterior
        median, what was measured, and the friction from which on the board would not move.
    """
    table = predictive["prior"].to_dataset()
    sizes = ordered_sizes(table["pulley"].to_numpy())
    measured = table["measured_n"].to_numpy()
    least = max(LEAST_FRICTION_N, float(measured.min()))
    with figure(height=58.0) as fig:
        panels = fig.subplots(1, len(sizes), squeeze=False, sharey=True)[0]
        for axes, size in zip(panels, sizes, strict=True):
            of_size = np.flatnonzero(table["pulley_size"].to_numpy() == size)
            of_size = of_size[np.argsort(measured[of_size], kind="stable")]
            _draw(axes, table.isel(condition=of_size))
            axes.set_yscale("symlog", linthresh=least, linscale=0.4)
            axes.yaxis.set_major_formatter(powers())
            axes.set_title(f"{plain(size)} pulley")
        panels[0].set_ylabel("friction [N]")
        panels[len(sizes) // 2].set_xlabel("conditions, in the order of measured friction")
        keys = [
            area_key("prior, 90 %", 0.15),
            area_key("prior, 50 %", 0.4),
            line_key("posterior, median", color=COLORS["blue"]),
            line_key("measured", color=COLORS["black"], marker=".", linestyle=""),
        ]
        if "drive_n" in table:
            label = "does not move from here"
            keys.append(line_key(label, color=COLORS["vermilion"], linestyle="", marker="_"))
        key(fig, keys, ncols=len(keys))
        return fig


def _draw(axes: Axes, table: xr.Dataset) -> None:
    place = np.arange(1, table.sizes["condition"] + 1)
    prior, posterior = table["prior_n"].to_numpy(), table["posterior_n"].to_numpy()
    edges = np.concatenate([place - 0.5, place[-1:] + 0.5])
    for low, high, alpha in ((0, 4, 0.15), (1, 3, 0.3)):
        axes.stairs(
            prior[:, high],
            edges,
            baseline=prior[:, low],
            fill=True,
            color=NEUTRAL,
            alpha=alpha,
            linewidth=0,
        )
    axes.stairs(posterior[:, 2], edges, color=COLORS["blue"], baseline=None, linewidth=2.4)
    axes.plot(place, table["measured_n"].to_numpy(), ".", color=COLORS["black"], markersize=2.0)
    if "drive_n" in table:
        drive = table["drive_n"].to_numpy()
        axes.plot(place, drive, "_", color=COLORS["vermilion"], markersize=3.0)
    axes.set_xlim(edges[0], edges[-1])

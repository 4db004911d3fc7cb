"""Rank histograms by ensemble: flat where the ensembles draw from one density."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from bayesfric.plots.style import COLORS, NEUTRAL, figure

__all__ = ["rank_histograms"]

LINES = ("-", "--", "-.", ":")
COLUMNS = 4


def rank_histograms(predictive: xr.DataTree) -> Figure:
    """Draw how the draws of each ensemble rank among all, a panel a parameter.

    Parameters
    ----------
    predictive : DataTree
        ``predictive.nc`` with its group ``ranks``.

    Returns
    -------
    Figure
        Counts relative to those expected.
    """
    table = predictive["ranks"].to_dataset()
    names = [str(name) for name in table["parameter"].to_numpy()]
    rows = -(-len(names) // COLUMNS)
    shades = [COLORS[name] for name in ("blue", "vermilion", "green", "purple")]
    with figure(height=24.0 * rows + 6.0) as fig:
        panels = np.atleast_2d(fig.subplots(rows, COLUMNS, sharex=True, sharey=True))
        for panel, name in zip(panels.flat, names, strict=False):
            heights = table["relative"].sel(parameter=name).to_numpy()
            edges = np.linspace(0, 1, heights.shape[1] + 1)
            for ensemble, row in enumerate(heights):
                panel.stairs(
                    row,
                    edges,
                    color=shades[ensemble % len(shades)],
                    linestyle=LINES[ensemble % len(LINES)],
                    linewidth=0.9,
                    baseline=None,
                )
            panel.axhline(1.0, color=NEUTRAL, linewidth=0.6)
            panel.set_title(name.replace("[", " ").rstrip("]"))
            panel.set_ylim(0, 2)
        for panel in panels.flat[len(names) :]:
            panel.set_visible(False)
        fig.supxlabel("rank among all draws", fontsize=8)
        fig.supylabel("count / expected", fontsize=8)
        return fig

"""Rank histograms by ensemble: flat where the ensembles draw from one density."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from bayesfric.plots.labels import parameter_label
from bayesfric.plots.style import COLORS, LINES, NEUTRAL, LineStyle, key, line_key, small_panels

SHADES = tuple(COLORS[name] for name in ("blue", "vermilion", "green", "purple"))
KEYS = 8  # more ensembles than that are not told apart


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
    relative = table["relative"].to_numpy()
    ensembles = relative.shape[1]
    with small_panels(len(names), 14.0, alike=True) as (fig, panels):
        for panel, name in zip(panels, names, strict=True):
            heights = table["relative"].sel(parameter=name).to_numpy()
            edges = np.linspace(0, 1, heights.shape[1] + 1)
            for ensemble, row in enumerate(heights):
                color, line = _look(ensemble)
                panel.stairs(row, edges, color=color, linestyle=line, linewidth=0.9, baseline=None)
            panel.axhline(1.0, color=NEUTRAL, linewidth=0.6, zorder=1)
            panel.set_title(parameter_label(name))
            panel.set_xticks([0, 0.5, 1], ["0", "0.5", "1"])
        # The same for all panels, and no narrower than what is of interest.
        top = max(1.5, float(relative.max()))
        panels[0].set_ylim(min(2 - top, 0.5), top)
        fig.supxlabel("rank among all draws", fontsize=8)
        fig.supylabel("count / expected", fontsize=8)
        if ensembles <= KEYS:
            keys = [
                line_key(f"ensemble {e + 1}", color=_look(e)[0], linestyle=_look(e)[1])
                for e in range(ensembles)
            ]
            key(fig, keys, side="above", ncols=min(4, ensembles))
        return fig


def _look(ensemble: int) -> tuple[str, LineStyle]:
    return SHADES[ensemble % len(SHADES)], LINES[ensemble % len(LINES)]

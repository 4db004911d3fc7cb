"""Ranks: of each ensemble's draws among all, and of truths among posterior draws."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from bayesfric.plots.labels import parameter_label
from bayesfric.plots.style import (
    COLORS,
    LINES,
    NEUTRAL,
    LineStyle,
    area_key,
    key,
    line_key,
    small_panels,
)
from bayesfric.schemas import CalibrationFile

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


def rank_differences(calibration: CalibrationFile) -> Figure:
    """Draw the difference of distribution functions, a panel a quantity.

    Parameters
    ----------
    calibration : CalibrationFile
        ``calibration.json``.

    Returns
    -------
    Figure
        A step line in a band; one that leaves it is vermilion.
    """
    low, high = np.array(calibration.low), np.array(calibration.high)
    at = np.array(calibration.probability)
    quantities = calibration.quantities
    with small_panels(len(quantities), 14.0, alike=True) as (fig, panels):
        for panel, quantity in zip(panels, quantities, strict=True):
            panel.fill_between(at, low, high, color=NEUTRAL, alpha=0.18, linewidth=0)
            panel.axhline(0.0, color=NEUTRAL, linewidth=0.6)
            color = COLORS["blue" if quantity.inside else "vermilion"]
            panel.step(at, quantity.difference, where="mid", color=color, linewidth=0.9)
            panel.set_title(parameter_label(quantity.name))
            panel.set_xticks([0, 0.5, 1], ["0", "0.5", "1"])
        fig.supxlabel("rank of the truth among posterior draws, over the largest", fontsize=8)
        fig.supylabel("share of truths below it, less the uniform", fontsize=8)
        keys = [
            line_key("truths", color=COLORS["blue"]),
            area_key("uniform ranks, all quantities", 0.3),
        ]
        key(fig, keys, side="above", ncols=2)
        return fig

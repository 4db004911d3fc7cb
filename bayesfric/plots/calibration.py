"""Distribution of ranks less the uniform one, with the band that uniform ranks stay within."""

import numpy as np
from matplotlib.figure import Figure

from bayesfric.plots.labels import parameter_label
from bayesfric.plots.style import COLORS, NEUTRAL, area_key, key, line_key, small_panels
from bayesfric.schemas import CalibrationFile


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

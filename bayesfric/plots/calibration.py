"""Distribution of ranks less the uniform one, with the band that uniform ranks stay within."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from bayesfric.plots.labels import columns_of, parameter_label
from bayesfric.plots.style import COLORS, NEUTRAL, figure, key
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
    names = [quantity.name for quantity in calibration.quantities]
    columns = columns_of(len(names))
    rows = -(-len(names) // columns)
    low, high = np.array(calibration.low), np.array(calibration.high)
    at = np.array(calibration.probability)
    with figure(height=18.0 * rows + 14.0) as fig:
        panels = np.reshape(fig.subplots(rows, columns, sharex=True, sharey=True), (rows, columns))
        for place, (panel, quantity) in enumerate(
            zip(panels.flat, calibration.quantities, strict=False)
        ):
            panel.fill_between(at, low, high, color=NEUTRAL, alpha=0.18, linewidth=0)
            panel.axhline(0.0, color=NEUTRAL, linewidth=0.6)
            color = COLORS["blue" if quantity.inside else "vermilion"]
            panel.step(at, quantity.difference, where="mid", color=color, linewidth=0.9)
            panel.set_title(parameter_label(quantity.name))
            panel.set_xticks([0, 0.5, 1], ["0", "0.5", "1"])
            panel.tick_params(labelbottom=place + columns >= len(names))
        for panel in panels.flat[len(names) :]:
            panel.set_visible(False)
        fig.supxlabel("rank of the truth among posterior draws, over the largest", fontsize=8)
        fig.supylabel("share of truths below it, less the uniform", fontsize=8)
        keys: list[Line2D | Patch] = [
            Line2D([], [], color=COLORS["blue"], label="truths"),
            Patch(color=NEUTRAL, alpha=0.3, linewidth=0, label="uniform ranks, all quantities"),
        ]
        key(fig, keys, side="above", ncols=2)
        return fig

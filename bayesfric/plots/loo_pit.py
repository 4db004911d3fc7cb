"""Leave-one-trial-out probabilities: their distribution less the uniform one."""

import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from bayesfric.plots.labels import plain
from bayesfric.plots.rig_tables import rig_tables
from bayesfric.plots.style import COLORS, NEUTRAL, figure, key


def has_probabilities(predictive: xr.DataTree) -> bool:
    """Tell whether any rig's trials were left out one at a time."""
    return any(
        rig.checks is not None and "pit_difference" in rig.checks for rig in rig_tables(predictive)
    )


def leave_one_out_probabilities(predictive: xr.DataTree) -> Figure:
    """Draw the distribution of the probabilities less the uniform one, a panel a rig.

    Parameters
    ----------
    predictive : DataTree
        ``predictive.nc`` with ``pit_difference`` among the checks of some rig.

    Returns
    -------
    Figure
        A step line, and the band that 95 % of recordings made again stay within.
    """
    tables = {
        f"{plain(rig.title)}, {plain(rig.trials)}": rig.checks
        for rig in rig_tables(predictive)
        if rig.checks is not None and "pit_difference" in rig.checks
    }
    with figure(height=40.0) as fig:
        panels = fig.subplots(1, len(tables), squeeze=False, sharey=True)[0]
        for axes, (title, table) in zip(panels, tables.items(), strict=True):
            at = table["probability"].to_numpy()
            low, high = table["pit_band"].to_numpy()
            axes.fill_between(at, low, high, color=NEUTRAL, alpha=0.18, linewidth=0)
            axes.axhline(0.0, color=NEUTRAL, linewidth=0.8)
            difference = table["pit_difference"].to_numpy()
            axes.step(at, difference, where="mid", color=COLORS["blue"])
            axes.set_xlim(0, 1)
            axes.set_title(title)
            axes.set_xlabel("probability of less friction, left out")
        panels[0].set_ylabel("share below it\nless the uniform")
        keys: list[Line2D | Patch] = [
            Line2D([], [], color=COLORS["blue"], label="this recording"),
            Patch(color=NEUTRAL, alpha=0.3, linewidth=0, label="95 % of recordings made again"),
        ]
        key(fig, keys, ncols=2)
        return fig

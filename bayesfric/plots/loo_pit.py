"""Leave-one-trial-out probabilities: their distribution less the uniform one."""

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bayesfric.plots.labels import plain
from bayesfric.plots.rig_tables import rig_tables
from bayesfric.plots.style import COLORS, NEUTRAL, area_key, figure, key, line_key


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
            draw_probabilities(axes, table, title)
        panels[0].set_ylabel("share below it\nless the uniform")
        keys = [
            line_key("this recording", color=COLORS["blue"]),
            area_key("95 % of recordings made again", 0.3),
        ]
        key(fig, keys, ncols=2)
        return fig


def draw_probabilities(axes: Axes, table: xr.Dataset, title: str) -> None:
    """Draw the share of left-out probabilities below each, less the uniform, in its band."""
    at = table["probability"].to_numpy()
    low, high = table["pit_band"].to_numpy()
    axes.fill_between(at, low, high, color=NEUTRAL, alpha=0.18, linewidth=0)
    axes.axhline(0.0, color=NEUTRAL, linewidth=0.8)
    axes.step(at, table["pit_difference"].to_numpy(), where="mid", color=COLORS["blue"])
    axes.set_xlim(0, 1)
    axes.set_title(title)
    axes.set_xlabel("probability of less friction")

"""Trials as the paper's Fig. 11 shows them: travel against time, and what is left."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from bayesfric.plots.style import COLORS, figure, size_styles

__all__ = ["measured_and_predicted"]


def measured_and_predicted(predictive: xr.DataTree) -> Figure:
    """Draw a few trials, measured and predicted from their first speed alone.

    Parameters
    ----------
    predictive : DataTree
        ``predictive.nc`` with its group ``trajectories``.

    Returns
    -------
    Figure
        A pair of panels a trial: travel, and measured minus predicted with the
        5 % to 95 % band of a new trial on a new assembly.
    """
    table = predictive["trajectories"].to_dataset()
    shown = table["shown"].to_numpy()
    columns = min(3, len(shown))
    blocks = -(-len(shown) // columns)
    styles = size_styles([str(size) for size in table["pulley_size"].to_numpy()])
    with figure(height=66.0 * blocks) as fig:
        grid = fig.add_gridspec(2 * blocks, columns, height_ratios=[3, 2] * blocks)
        for place in range(len(shown)):
            trial = table.isel(shown=place)
            seen = np.isfinite(trial["time_s"].to_numpy())
            time = trial["time_s"].to_numpy()[seen]
            travel = trial["travel_m"].to_numpy()[seen]
            low, middle, high = trial["predicted_m"].to_numpy()[seen].T
            look = styles[str(trial["pulley_size"].item())]
            block, column = divmod(place, columns)
            top = fig.add_subplot(grid[2 * block, column])
            below = fig.add_subplot(grid[2 * block + 1, column], sharex=top)
            top.fill_between(time, low, high, color=look.color, alpha=0.3, linewidth=0)
            top.plot(time, middle, color=look.color, linewidth=1.0)
            top.plot(time, travel, ".", color=COLORS["black"], markersize=2.0)
            top.set_title(
                f"{trial['pulley_size'].item()}, n = {trial['n_pulleys'].item()}, "
                f"{trial['wrap_angle_deg'].item():g}°\n"
                f"{trial['mass_drive_kg'].item():.3f} / {trial['mass_load_kg'].item():.3f} kg"
            )
            top.tick_params(labelbottom=False)
            below.fill_between(
                time,
                1e3 * (low - middle),
                1e3 * (high - middle),
                color=look.color,
                alpha=0.3,
                linewidth=0,
            )
            below.plot(time, 1e3 * (travel - middle), ".", color=COLORS["black"], markersize=2.0)
            below.axhline(0, color=look.color, linewidth=0.8)
            below.set_xlabel("time [s]")
            if column == 0:
                top.set_ylabel("travel [m]")
                below.set_ylabel("measured −\npredicted [mm]")
        fig.align_ylabels()
        return fig

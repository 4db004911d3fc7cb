"""Trials as the paper's Fig. 11 shows them: travel against time, and what is left."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from bayesfric.plots.labels import ordered_sizes, plain
from bayesfric.plots.style import COLORS, NEUTRAL, area_key, figure, key, line_key, size_styles

COLUMNS = 3
SHOWN_EVENTS = 15  # of a trial's travel, so that the line stays visible; residuals show all


def measured_and_predicted(predictive: xr.DataTree) -> Figure:
    """Draw a few trials, measured and predicted from their first speed alone.

    Parameters
    ----------
    predictive : DataTree
        ``predictive.nc`` with its group ``trajectories``.

    Returns
    -------
    Figure
        A pair of panels a trial, fast trials of a size above its slow ones: travel,
        and measured minus median with the 5 % to 95 % band of a new trial on a new
        assembly.
    """
    table = predictive["trajectories"].to_dataset()
    table = table.isel(shown=_by_size_and_duration(table))
    count = table.sizes["shown"]
    blocks = -(-count // COLUMNS)
    columns = -(-count // blocks)
    styles = size_styles(ordered_sizes(table["pulley_size"].to_numpy()))
    with figure(height=36.0 * blocks + 8.0) as fig:
        grid = fig.add_gridspec(2 * blocks, columns, height_ratios=[5, 4] * blocks)
        for place in range(count):
            trial = table.isel(shown=place)
            color = styles[str(trial["pulley_size"].item())].color
            column, block = divmod(place, blocks)
            top = fig.add_subplot(grid[2 * block, column])
            below = fig.add_subplot(grid[2 * block + 1, column], sharex=top)
            _draw_trial(top, below, trial, color)
            if block == blocks - 1:
                below.set_xlabel("time [s]")
            if column == 0:
                top.set_ylabel("travel [m]")
                below.set_ylabel("residual\n[mm]")
        keys = [
            line_key("Hall event", color=COLORS["black"], marker="o", markersize=2.2, linestyle=""),
            line_key("predicted median", color=NEUTRAL, linewidth=1.0),
            area_key("5 % to 95 % of new trials", 0.3),
        ]
        key(fig, keys, ncols=len(keys))
        return fig


def _draw_trial(top: Axes, below: Axes, trial: xr.Dataset, color: str) -> None:
    """Draw the travel of a trial, and below it what is measured less what is predicted."""
    seen = np.isfinite(trial["time_s"].to_numpy())
    time = trial["time_s"].to_numpy()[seen]
    travel = trial["travel_m"].to_numpy()[seen]
    low, middle, high = trial["predicted_m"].to_numpy()[seen].T
    top.fill_between(time, low, high, color=color, alpha=0.3, linewidth=0)
    top.plot(time, middle, color=color, linewidth=1.0)
    top.plot(
        time,
        travel,
        "o",
        color=COLORS["black"],
        markersize=2.2,
        markevery=max(1, len(time) // SHOWN_EVENTS),
    )
    top.set_title(
        f"{plain(str(trial['pulley_size'].item()))}, n = {trial['n_pulleys'].item()}, "
        f"{trial['wrap_angle_deg'].item():g}°\n"
        f"{trial['mass_drive_kg'].item():.3f} / {trial['mass_load_kg'].item():.3f} kg"
    )
    top.tick_params(labelbottom=False)
    below.fill_between(
        time, 1e3 * (low - middle), 1e3 * (high - middle), color=color, alpha=0.3, linewidth=0
    )
    below.axhline(0, color=color, linewidth=1.0)
    below.plot(time, 1e3 * (travel - middle), "o", color=COLORS["black"], markersize=1.4)
    # The panel has room for two numbers; its line is at zero.
    tick = MaxNLocator(2).tick_values(0.0, max(map(abs, below.get_ylim())))[1]
    below.set_yticks([-tick, tick])


def _by_size_and_duration(table: xr.Dataset) -> list[int]:
    """Return the places of the trials, by size and then from fast to slow."""
    sizes = [str(size) for size in table["pulley_size"].to_numpy()]
    order = ordered_sizes(sizes)
    duration = np.nanmax(table["time_s"].to_numpy(), axis=1)
    return sorted(range(len(sizes)), key=lambda place: (order.index(sizes[place]), duration[place]))

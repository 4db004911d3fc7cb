"""Friction against the wrap angle, as in the paper's Fig. 14."""

from itertools import cycle

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bayesfric.plots.labels import ordered_sizes, plain
from bayesfric.plots.style import (
    LINES,
    MARKERS,
    NEUTRAL,
    area_key,
    figure,
    hollow,
    key,
    line_key,
    point_key,
    size_styles,
)


def friction_against_wrap(predictive: xr.DataTree) -> Figure:
    """Draw friction against the wrap angle, a row for each n and a column for each size.

    Parameters
    ----------
    predictive : DataTree
        ``predictive.nc`` with its group ``wrap_lines``.

    Returns
    -------
    Figure
        In each panel, for each tension: what was measured, with the 5 % to 95 % bar of
        recordings made again, and the law's band.
    """
    table = predictive["wrap_lines"].to_dataset()
    sizes = ordered_sizes(table["pulley_size"].to_numpy())
    styles = size_styles(sizes)
    counts = table["count"].to_numpy()
    levels = table["level"].to_numpy()
    grid = table["law_angle_deg"].to_numpy()
    with figure(height=18.0 + 24.0 * len(counts)) as fig:
        panels = fig.subplots(len(counts), len(sizes), squeeze=False, sharex=True)
        for row, n in enumerate(counts):
            for column, size in enumerate(sizes):
                axes, look = panels[row, column], styles[size]
                of_condition = (table["pulley_size"] == size) & (table["n_pulleys"] == n)
                for line in np.flatnonzero(of_condition):
                    some = table.isel(line=line)
                    place = int(np.flatnonzero(levels == some["tension_n"].item())[0])
                    _draw_line(axes, grid, some, look.color, place)
                axes.set_ylim(bottom=0)
                if row == 0:
                    axes.set_title(plain(size))
                if row == len(counts) - 1:
                    axes.set_xlabel("wrap angle θ [°]")
                if column == 0:
                    axes.set_ylabel(f"n = {n}\nfriction [N]")
        keys = [
            point_key(f"T = {level:.1f} N", NEUTRAL, marker, line, 3.4)
            for level, marker, line in zip(levels, cycle(MARKERS), cycle(LINES), strict=False)
        ]
        keys.append(line_key("made again, 5 % to 95 %", color=NEUTRAL, linewidth=0.9))
        keys.append(area_key("law, 5 % to 95 %", 0.4))
        key(fig, keys, ncols=3)
        return fig


def _draw_line(axes: Axes, grid: np.ndarray, line: xr.Dataset, color: str, level: int) -> None:
    """Draw friction at one tension: the law's band over `grid`, and what was measured."""
    low, middle, high = line["law_n"].to_numpy().T
    axes.fill_between(grid, low, high, color=color, alpha=0.3, linewidth=0)
    axes.plot(grid, middle, color=color, linewidth=0.9, linestyle=LINES[level % len(LINES)])
    angle = line["wrap_angle_deg"].to_numpy()
    again = line["friction_again_n"].to_numpy()
    axes.vlines(angle, again[:, 0], again[:, 2], color=NEUTRAL, linewidth=0.9, zorder=2.5)
    axes.plot(
        angle,
        line["friction_n"],
        MARKERS[level % len(MARKERS)],
        **hollow(color, 3.4, markeredgewidth=0.9, zorder=3),
    )

"""Friction against the wrap angle, as in the paper's Fig. 14."""

from itertools import cycle

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from bayesfric.plots.labels import ordered_sizes, plain
from bayesfric.plots.slopes import MARKER_SIZE, draw_law, draw_points, keys_of_repeats
from bayesfric.plots.style import LINES, MARKERS, NEUTRAL, figure, key, point_key, size_styles


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
                    marker, dash = MARKERS[place % len(MARKERS)], LINES[place % len(LINES)]
                    draw_law(axes, grid, some["law_n"].to_numpy(), look.color, dash)
                    draw_points(
                        axes,
                        some["wrap_angle_deg"].to_numpy(),
                        some["friction_n"].to_numpy(),
                        some["friction_again_n"].to_numpy(),
                        look.color,
                        marker,
                    )
                axes.set_ylim(bottom=0)
                if row == 0:
                    axes.set_title(plain(size))
                if row == len(counts) - 1:
                    axes.set_xlabel("wrap angle θ [°]")
                if column == 0:
                    axes.set_ylabel(f"n = {n}\nfriction [N]")
        keys = [
            point_key(f"T = {level:.1f} N", NEUTRAL, marker, line, MARKER_SIZE)
            for level, marker, line in zip(levels, cycle(MARKERS), cycle(LINES), strict=False)
        ]
        key(fig, [*keys, *keys_of_repeats()], ncols=3)
        return fig

"""Slopes of friction, and friction against the wrap angle, as in the paper's Figs 13 to 16."""

from itertools import cycle

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bayesfric.plots.labels import ordered_sizes, plain
from bayesfric.plots.style import (
    LINES,
    MARKERS,
    NEUTRAL,
    PAPER_LINE,
    LineStyle,
    area_key,
    figure,
    hollow,
    key,
    line_key,
    point_key,
    size_styles,
)

MARKER_SIZE = 3.6


def line_against_pulleys(predictive: xr.DataTree) -> Figure:
    """Draw slope and intercept of friction against tension over n, at 85°.

    Parameters
    ----------
    predictive : DataTree
        ``predictive.nc`` with its group ``tension_lines``.

    Returns
    -------
    Figure
        A column a size, slopes above and intercepts below: measured, with the 5 % to
        95 % bar of recordings made again, the law's band, and Table I.
    """
    table = predictive["tension_lines"].to_dataset()
    cells = table.isel(cell=np.flatnonzero(table["upright"]))
    sizes = ordered_sizes(cells["pulley_size"].to_numpy())
    styles = size_styles(sizes)
    count = table["n"].to_numpy()
    rows = (("slope", "", "slope [10⁻³]"), ("intercept", "_n", "intercept [mN]"))
    with figure(height=62.0) as fig:
        panels = fig.subplots(2, len(sizes), squeeze=False, sharex=True)
        for column, size in enumerate(sizes):
            some = cells.isel(cell=np.flatnonzero(cells["pulley_size"] == size))
            look = styles[size]
            for axes, (name, unit, label) in zip(panels[:, column], rows, strict=True):
                law = 1e3 * table[f"{name}_law{unit}"].sel(pulley=size).to_numpy()
                draw_law(axes, count, law, look.color, "-")
                printed = 1e3 * table[f"{name}_paper{unit}"].sel(pulley=size).to_numpy()
                if np.isfinite(printed).all():
                    axes.plot(count, printed, **PAPER_LINE)
                draw_points(
                    axes,
                    some["n_pulleys"].to_numpy(),
                    1e3 * some[f"{name}{unit}"].to_numpy(),
                    1e3 * some[f"{name}_again{unit}"].to_numpy(),
                    look.color,
                    look.marker,
                )
                if column == 0:
                    axes.set_ylabel(label)
            panels[0, column].set_title(plain(size))
            panels[1, column].set_xlabel("number of pulleys n")
            panels[1, column].set_xlim(left=0)
        keys = _keys()
        if np.isfinite(table["slope_paper"].to_numpy()).any():
            keys.append(line_key("paper's law", **PAPER_LINE))
        key(fig, keys, ncols=len(keys))
        return fig


def wrap_slopes(predictive: xr.DataTree) -> Figure:
    """Draw the slope of friction in the wrap angle over n and over tension.

    Parameters
    ----------
    predictive : DataTree
        ``predictive.nc`` with its group ``wrap_lines``.

    Returns
    -------
    Figure
        A column a size. Above, slopes against n, a marker and a line style for each
        tension; below, the same slopes against tension, for each n.
    """
    table = predictive["wrap_lines"].to_dataset()
    sizes = ordered_sizes(table["pulley_size"].to_numpy())
    styles = size_styles(sizes)
    rows = (
        ("n_pulleys", "n", "law_against_n", "tension_n", "level", "T = {:.1f} N"),
        ("tension_n", "tension", "law_against_tension", "n_pulleys", "count", "n = {:g}"),
    )
    with figure(height=70.0) as fig:
        panels = fig.subplots(2, len(sizes), squeeze=False, sharex="row")
        for column, size in enumerate(sizes):
            of_size = table.isel(line=np.flatnonzero(table["pulley_size"] == size))
            look = styles[size]
            for axes, (across, grid, law, by, along, text) in zip(
                panels[:, column], rows, strict=True
            ):
                handles = []
                for place, value in enumerate(table[along].to_numpy()):
                    some = of_size.isel(line=np.flatnonzero(of_size[by] == value))
                    if not some.sizes["line"]:
                        continue
                    marker, line = MARKERS[place % len(MARKERS)], LINES[place % len(LINES)]
                    band = table[law].sel({"pulley": size, along: value}).to_numpy()
                    draw_law(axes, table[grid].to_numpy(), 1e3 * band, look.color, line)
                    draw_points(
                        axes,
                        some[across].to_numpy(),
                        1e3 * some["slope_n_per_deg"].to_numpy(),
                        1e3 * some["slope_again_n_per_deg"].to_numpy(),
                        look.color,
                        marker,
                    )
                    handles.append(
                        point_key(text.format(value), look.color, marker, line, MARKER_SIZE)
                    )
                axes.legend(handles=handles, loc="upper left", fontsize=6, borderpad=0.1)
                axes.set_xlim(left=0)
                if column == 0:
                    axes.set_ylabel("slope in the wrap angle\n[mN/deg]")
            panels[0, column].set_title(plain(size))
            panels[0, column].set_xlabel("number of pulleys n")
            panels[1, column].set_xlabel("nominal tension T [N]")
        keys = _keys()
        key(fig, keys, ncols=len(keys))
        return fig


def draw_law(axes: Axes, x: np.ndarray, law: np.ndarray, color: str, line: LineStyle) -> None:
    """Draw the law's median and its band, shape (len(x), 3)."""
    low, middle, high = law.T
    axes.fill_between(x, low, high, color=color, alpha=0.25, linewidth=0)
    axes.plot(x, middle, color=color, linewidth=0.9, linestyle=line)


def draw_points(
    axes: Axes, x: np.ndarray, y: np.ndarray, again: np.ndarray, color: str, marker: str
) -> None:
    """Draw what was measured, with the bars of recordings made again, shape (len(x), 3)."""
    axes.vlines(x, again[:, 0], again[:, 2], color=NEUTRAL, linewidth=0.9, zorder=2.5)
    axes.plot(x, y, marker, **hollow(color, MARKER_SIZE, markeredgewidth=0.9, zorder=3))


def keys_of_repeats() -> list[Artist]:
    """Return what explains the bars of recordings made again, and the law's band."""
    return [
        line_key("made again, 5 % to 95 %", color=NEUTRAL, linewidth=0.9),
        area_key("law, 5 % to 95 %", 0.4),
    ]


def _keys() -> list[Artist]:
    measured = line_key("measured", marker="o", linestyle="", **hollow(NEUTRAL, MARKER_SIZE))
    return [measured, *keys_of_repeats()]


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

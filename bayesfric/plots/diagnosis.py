"""The diagnosis: where simulation misses the board, and which effect causes it."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from bayesfric.plots.labels import axis_words, plain, rounded
from bayesfric.plots.live import Band, Chart, Cloud, Curve
from bayesfric.plots.style import COLORS, NEUTRAL, SHADES, figure, halves, key, line_key, name_rows
from bayesfric.probabilities import stated
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import Inclusion
from bayesfric.schemas.gap import Axis, Gap, GapRow
from bayesfric.stored_names import RESIDUALS, variable_of

BARS = 10  # axes whose share is drawn; the table has all
FEW_BARS = 4  # a single bar is no wider than one of so many
ALONE: dict[str, Any] = {
    "marker": "D", "markersize": 3.0, "markerfacecolor": "white", "linestyle": "none",
    "markeredgecolor": COLORS["black"], "markeredgewidth": 0.8,
}  # fmt: skip
SHAPES = 4  # axes whose shape is drawn: those of the largest shares
EFFECTS = 8  # most probable ones; the table has all
FEWEST = 4  # effects that are drawn at least
RARE = 0.02  # further effects are drawn where they are more probable
KINDS = 8  # ticks along kinds that are named
FITS = 22  # characters of a label below a panel; a longer one is smaller
ROOM = 2.0  # a panel of a shape is this much taller than its band; dots beyond are cut
CATEGORIES = ("pulley_size", "rig", "drive_end", "setup", "sensor")  # not numbers, but kinds
UNITS = {"": "", "1": "", "-": "", "deg": "°", "1/deg": "deg⁻¹", "1/m": "m⁻¹", "m/s^2": "m/s²"}


def where_it_lies(
    axes: Sequence[Axis],
    residuals: xr.Dataset | None,
    unit: str = "N",
    sizes: Sequence[str] = (),
    unexplained: Interval | None = None,
) -> Figure:
    """Draw the share of each axis that varied, and the residual force along those that matter most.

    Parameters
    ----------
    axes : sequence of Axis
        Of ``diagnosis.json``, largest share first.
    residuals : Dataset or None
        Group ``residuals`` of ``diagnosis.nc``: its dots stand behind the shapes of the
        axes that it holds.
    unit : str
        Of the force.
    sizes : sequence of str
        Pulley sizes by their numbers along an axis; without them the numbers stand there.
    unexplained : Interval or None
        Share of none of the axes, drawn below them if there is one.

    Returns
    -------
    Figure
        Left a bar with its interval for each of up to ten axes, dark for one that leads, and what
        the axis explains alone; right a panel for each of up to four shapes, if there is one.
    """
    shapes = [axis for axis in axes if axis.shape is not None][:SHAPES]
    shares = [axis for axis in axes if axis.share is not None][:BARS]
    with figure(height=max(46.0, 16.0 + 3.5 * len(shares))) as fig:
        left, right = halves(fig, 5, 6) if shapes else (fig, None)
        _shares(left.subplots(), shares, unexplained)
        keys = [
            Patch(color=COLORS["blue"], label="dominates"),
            Patch(color=COLORS["sky"], label="share"),
            line_key("alone", **ALONE),
        ]
        key(left, keys, side="above", align="left", ncols=3, columnspacing=1.0)
        if right is not None:
            columns = min(2, len(shapes))
            rows = -(-len(shapes) // columns)
            panels = np.reshape(right.subplots(rows, columns), -1)
            for panel, axis in zip(panels, shapes, strict=False):
                _shape(panel, axis, residuals, sizes if axis.axis == "pulley_size" else ())
            for panel in panels[len(shapes) :]:
                panel.set_visible(False)
            right.supylabel(f"residual force [{unit}]", fontsize=8)
        return fig


def axis_charts(axes: Sequence[Axis], residuals: xr.Dataset | None, unit: str) -> list[Chart]:
    """Return the residual force along the axis of the largest share, as one chart.

    Parameters
    ----------
    axes, residuals, unit
        As of :func:`where_it_lies`.

    Returns
    -------
    list of Chart
        One, of the first axis that has a shape and is no list of kinds; none without such an axis.
    """
    shaped = [a for a in axes if a.shape is not None and a.axis not in CATEGORIES]
    if not shaped or shaped[0].shape is None:
        return []
    axis, shape = shaped[0], shaped[0].shape
    grid, low, high = (np.asarray(v) for v in (shape.grid, shape.low_n, shape.high_n))
    label = with_unit(axis_words(axis.axis), axis.unit)
    clouds = []
    variable = variable_of(axis.axis, RESIDUALS)
    if residuals is not None and variable in residuals.data_vars:
        clouds = _windows(residuals, variable)
    return [
        Chart(
            title="Residual force on held-out data; line and band: its systematic part, 95 %",
            x_label=label,
            y_label=f"residual force [{unit}]",
            columns=["trial", label, f"residual [{unit}]", f"friction [{unit}]"],
            clouds=clouds,
            curves=[Curve("", COLORS["blue"], grid, np.asarray(shape.gap_n))],
            bands=[Band("", COLORS["blue"], grid, low, high)],
        )
    ]


def _windows(residuals: xr.Dataset, variable: str) -> list[Cloud]:
    """Return the windows of each rig, with the words of each."""
    rigs = residuals["rig"].to_numpy()
    names, places = residuals["trial"].to_numpy(), residuals[variable].to_numpy()
    left, friction = residuals["residual_n"].to_numpy(), residuals["friction_n"].to_numpy()
    clouds = []
    for rig, color in zip(sorted(set(rigs.tolist())), SHADES, strict=False):
        rows = np.flatnonzero((rigs == rig) & np.isfinite(places))
        said = [
            [str(names[k]), f"{places[k]:.3g}", f"{left[k]:.2g}", f"{friction[k]:.3g}"]
            for k in rows
        ]
        clouds.append(Cloud(str(rig), color, "o", places[rows], left[rows], said=said))
    return clouds


def _shares(panel: Axes, axes: Sequence[Axis], unexplained: Interval | None) -> None:
    """Draw a bar for each share, and one of what is left."""
    rows = [(axis_label(axis.axis), axis.share, axis.alone, axis.answers) for axis in axes]
    if unexplained is not None:
        rows.append(("none of these", unexplained, None, False))
    for row, (name, share, alone, leads) in enumerate(rows):
        if share is None:
            raise ValueError(f"{name}: expected a share, got none")
        color = COLORS["blue"] if leads else COLORS["sky"] if row < len(axes) else NEUTRAL
        panel.barh(row, share.q50, height=0.72, color=color)
        panel.plot([share.q05, share.q95], [row, row], color=COLORS["black"], linewidth=1.2)
        ends = [share.q50, share.q95]
        if alone is not None:
            panel.plot([alone.q50], [row], **ALONE)
            ends.append(alone.q50 + 0.015)
        panel.text(max(ends) + 0.02, row, f"{share.q50:.2f}", va="center", fontsize=7)
    panel.axvline(0.0, color=COLORS["black"], linewidth=0.8)
    name_rows(panel, [name for name, *_ in rows], room=FEW_BARS)
    panel.set_xlim(0.0, 1.2)
    panel.set_xticks([0.0, 0.5, 1.0])
    panel.set_xlabel("share of the systematic force (variance)")


def _shape(panel: Axes, axis: Axis, residuals: xr.Dataset | None, kinds: Sequence[str]) -> None:
    shape = axis.shape
    if shape is None:
        raise ValueError(f"{axis.axis}: expected a shape, got none")
    variable = variable_of(axis.axis, RESIDUALS)
    if residuals is not None and variable in residuals.data_vars:
        panel.plot(
            residuals[variable].to_numpy(),
            residuals["residual_n"].to_numpy(),
            "o",
            color="#b0b0b0",
            markersize=1.2,
            markeredgewidth=0,
            rasterized=residuals.sizes["row"] > 500,
            zorder=1,
        )
    low, high = min(shape.low_n), max(shape.high_n)
    middle, half = (low + high) / 2, ROOM * (high - low) / 2
    if axis.axis in CATEGORIES:
        panel.vlines(shape.grid, shape.low_n, shape.high_n, color=COLORS["blue"], linewidth=2.0)
        panel.plot(shape.grid, shape.gap_n, "o", color=COLORS["blue"])
    else:
        panel.fill_between(
            shape.grid, shape.low_n, shape.high_n, color=COLORS["blue"], alpha=0.35, linewidth=0
        )
        panel.plot(shape.grid, shape.gap_n, color=COLORS["blue"])
    panel.axhline(0.0, color=COLORS["black"], linewidth=0.7, linestyle="--")
    if half > 0:
        panel.set_ylim(min(middle - half, 0.0), max(middle + half, 0.0))
    first, last = min(shape.grid), max(shape.grid)
    if axis.axis in CATEGORIES:
        panel.set_xlim(first - 0.5, last + 0.5)
        step = -(-len(shape.grid) // KINDS)  # the names of more would overprint
        names = [str(place + 1) for place in range(len(shape.grid))]
        if kinds:
            names = [plain(kinds[round(number)]) for number in shape.grid]
        panel.set_xticks(shape.grid[::step], names[::step])
    else:
        panel.set_xlim(first - 0.03 * (last - first), last + 0.03 * (last - first))
        panel.xaxis.set_major_locator(MaxNLocator(4))
    panel.yaxis.set_major_locator(MaxNLocator(4))
    panel.tick_params(labelsize=6.5)
    words = with_unit(axis_label(axis.axis), axis.unit)
    panel.set_xlabel(words, fontsize=7.5 if len(words) <= FITS else 6.0, labelpad=1.5)


def what_acts(effects: Sequence[Inclusion], practical_share: float) -> Figure:
    """Draw how probable each effect is, and how strong.

    Parameters
    ----------
    effects : sequence of Inclusion
        The most probable first; the first eight are drawn.
    practical_share : float
        Of rms friction: what is below matters to nobody.
    """
    shown = [effect for k, effect in enumerate(effects) if k < FEWEST or effect.probability > RARE]
    shown = shown[:EFFECTS]
    with figure(height=17.0 + 4.0 * max(len(shown), FEWEST)) as fig:
        left, right = fig.subplots(1, 2, sharey=True, width_ratios=(1, 1))
        for row, effect in enumerate(shown):
            left.barh(row, effect.probability, height=0.66, color=COLORS["blue"])
            label = left.text(effect.probability + 0.02, row, stated(effect.probability))
            label.set(va="center", fontsize=7, zorder=3)
            label.set_bbox({"facecolor": "white", "edgecolor": "none", "pad": 0.5})
            if effect.strength is None:
                continue
            low, middle, high = (
                100 * q for q in (effect.strength.q05, effect.strength.q50, effect.strength.q95)
            )
            faint = 1.0 if effect.probability >= 0.5 else 0.4
            right.plot([low, high], [row, row], color=COLORS["blue"], linewidth=2.0, alpha=faint)
            right.plot(middle, row, "o", color=COLORS["blue"], alpha=faint)
        for mark in (0.1, 0.9):
            left.axvline(mark, color=NEUTRAL, linewidth=0.8, linestyle=":")
        right.axvline(100 * practical_share, color=COLORS["black"], linewidth=0.9, linestyle="--")
        name_rows(left, [plain(effect.effect) for effect in shown])
        left.set_xlim(0.0, 1.25)
        left.set_xticks([0.0, 0.5, 1.0])
        left.set_xlabel("probability that it acts")
        right.set_xlim(left=0.0)
        right.set_xlabel("strength [% of friction]")
        right.grid(visible=False, axis="y")
        return fig


def axis_label(name: str) -> str:
    """Write the name of an axis, as in `axis_words`, for a figure."""
    return plain(axis_words(name))


def with_unit(words: str, unit: str) -> str:
    """Write a name with its unit in brackets, if it has one."""
    unit = UNITS.get(unit, unit)
    return f"{words} [{plain(unit)}]" if unit else words


GAP_BARS = {
    "as_shipped": ("as shipped", "#8c8c8c"),
    "before": ("recalibrated", COLORS["vermilion"]),
    "after": ("with the effect", COLORS["blue"]),
    "floor": ("scatter (floor)", "#d0d0d0"),
    "systematic": ("systematic gap", COLORS["purple"]),
}


def how_far(
    gap: Gap, practical_share: float, trajectories: xr.Dataset | None, named: bool
) -> Figure:
    """Draw the gap as bars, and three held-out trajectories before and after.

    Parameters
    ----------
    gap : Gap
        Of ``diagnosis.json``.
    practical_share : float
        Of rms friction: what is below matters to nobody.
    trajectories : Dataset or None
        Group ``trajectories`` of ``diagnosis.nc``; None where there is none.
    named : bool
        Whether causes are named, so that there is something after.

    Returns
    -------
    Figure
        Left a panel in newtons and, where trajectories were run, one in millimetres; right
        a pair of panels a trial: its path, and simulated minus measured.
    """
    kinds: list[tuple[Gap | GapRow, float, str]] = [(gap, 1.0, f"force [{gap.unit}]")]
    if gap.trajectory is not None:
        kinds.append((gap.trajectory, 1e3, "trajectory [mm]"))
    with figure(height=57.0 if len(kinds) > 1 or trajectories is not None else 38.0) as fig:
        left, right = halves(fig, 3, 4) if trajectories is not None else (fig, None)
        panels = np.reshape(left.subplots(len(kinds), 1), -1)
        for panel, (row, scale, label) in zip(panels, kinds, strict=True):
            _bars(panel, row, scale, named)
            panel.set_xlabel(f"rms, held out: {label}", labelpad=1.5)
            if row is gap:
                limit = practical_share * gap.friction_rms
                panel.axvline(limit, color=COLORS["black"], linewidth=0.9, linestyle="--")
        if right is not None and trajectories is not None:
            _paths(right, trajectories, named)
        return fig


def _bars(panel: Axes, row: Gap | GapRow, scale: float, named: bool) -> None:
    names = []
    ends = [0.0]
    numbers = {name: getattr(row, name, None) for name in GAP_BARS if name != "after" or named}
    shown = {name: number for name, number in numbers.items() if number is not None}
    for place, (name, number) in enumerate(shown.items()):
        words, color = GAP_BARS[name]
        names.append(words)
        low, middle, high = scale * number.q05, scale * number.q50, scale * number.q95
        panel.barh(place, middle, height=0.66, color=color, edgecolor=COLORS["black"])
        panel.plot([low, high], [place, place], color=COLORS["black"], linewidth=1.2)
        label = panel.text(high, place, f"  {rounded(middle, low, high)}", va="center", fontsize=7)
        label.set_bbox({"facecolor": "white", "edgecolor": "none", "pad": 0.3})
        label.set_zorder(3)
        ends.append(high)
    panel.set_yticks(range(len(names)), names)
    panel.set_ylim(len(names) - 0.45, -0.55)
    panel.set_xlim(0.0, 1.25 * max(ends) or 1.0)
    panel.xaxis.set_major_locator(MaxNLocator(4))
    panel.grid(visible=False, axis="y")


def _paths(right: SubFigure, trajectories: xr.Dataset, named: bool) -> None:
    count = trajectories.sizes["example"]
    grid = right.subplots(2, count, sharex="col", height_ratios=(2, 3), squeeze=False)
    below = grid[1]
    for place in range(count):
        example = trajectories.isel(example=place)
        seen = np.isfinite(example["time_s"].to_numpy())
        time, measured, before, after = (
            example[name].to_numpy()[seen]
            for name in ("time_s", "measured_m", "before_m", "after_m")
        )
        grid[0, place].plot(time, measured, color=COLORS["black"], linewidth=1.0)
        grid[0, place].set_title(plain(str(example["trial"].item())), fontsize=8)
        panel = below[place]
        panel.axhline(0.0, color=COLORS["black"], linewidth=0.7)
        panel.plot(
            time, 1e3 * (before - measured), "--", color=COLORS["vermilion"], label="recalibrated"
        )
        if named:
            panel.plot(
                time, 1e3 * (after - measured), color=COLORS["blue"], label="with the effect"
            )
        panel.set_xlabel("time [s]", labelpad=1.5)
        for axes in (grid[0, place], panel):
            axes.tick_params(labelsize=6.5)
    grid[0, 0].set_ylabel("path\n[m]", fontsize=7.5)
    below[0].set_ylabel("simulated −\nmeasured [mm]", fontsize=7.5)
    handles = [
        line_key("recalibrated", color=COLORS["vermilion"], linestyle="--"),
        *([line_key("with the effect", color=COLORS["blue"])] if named else []),
    ]
    key(right, handles, side="above", align="right", ncols=2)

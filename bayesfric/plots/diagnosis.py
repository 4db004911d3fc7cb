"""The diagnosis: where simulation misses the board, and which effect causes it."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from bayesfric.plots.labels import axis_words, plain
from bayesfric.plots.style import COLORS, NEUTRAL, figure, halves, key
from bayesfric.probabilities import stated
from bayesfric.schemas.diagnosis import Axis, Inclusion
from bayesfric.stored_names import RESIDUALS, variable_of

__all__ = ["RARE", "what_acts", "where_it_lies"]

BARS = 10  # axes whose share is drawn; the table has all
FEW_BARS = 4  # a single bar is no wider than one of so many
ALL = 1.0  # of gap²; what is cross-validated may seem to take more away
SHAPES = 4  # axes whose shape is drawn: those of the largest shares
EFFECTS = 8  # most probable ones; the table has all
FEWEST = 4  # effects that are drawn at least
RARE = 0.02  # further effects are drawn where they are more probable
KINDS = 8  # ticks along kinds that are named
ROOM = 2.0  # a panel of a shape is this much taller than its band; dots beyond are cut
CATEGORIES = ("pulley_size", "rig", "drive_end", "setup", "sensor")  # not numbers, but kinds
UNITS = {"": "", "1": "", "-": "", "deg": "°", "1/deg": "deg⁻¹", "1/m": "m⁻¹", "m/s^2": "m/s²"}


def where_it_lies(
    axes: Sequence[Axis],
    residuals: xr.Dataset | None,
    unit: str = "N",
    sizes: Sequence[str] = (),
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

    Returns
    -------
    Figure
        Left a bar for each of up to ten axes that explain a part; right a panel for each of
        up to four shapes, if there is one. Shapes alone where no axis explains a part, and
        bars of all that varied where there are no shapes either.
    """
    known = [axis for axis in axes if not axis.blind]
    shapes = [axis for axis in axes if axis.shape is not None][:SHAPES]
    explaining = [axis for axis in known if (axis.share or 0.0) > 0]
    shares = (explaining or ([] if shapes else known))[:BARS]
    with figure(height=max(46.0, 12.0 + 3.5 * len(shares))) as fig:
        left: Figure | SubFigure | None = fig
        right: Figure | SubFigure | None = None
        if shapes:
            left, right = halves(fig, 5, 6) if shares else (None, fig)
        if left is not None:
            _shares(left.subplots(), shares)
            keys = [
                Patch(color=COLORS["sky"], label="by this axis alone"),
                Patch(color=COLORS["blue"], label="lost without it"),
            ]
            key(left, keys, side="above", align="left", ncols=2, columnspacing=1.0)
        if right is not None:
            columns = len(shapes) if left is None else min(2, len(shapes))
            rows = -(-len(shapes) // columns)
            panels = np.reshape(right.subplots(rows, columns), -1)
            for panel, axis in zip(panels, shapes, strict=False):
                _shape(panel, axis, residuals, sizes if axis.axis == "pulley_size" else ())
            for panel in panels[len(shapes) :]:
                panel.set_visible(False)
            right.supylabel(f"residual force [{unit}]", fontsize=8)
        return fig


def _shares(panel: Axes, axes: Sequence[Axis]) -> None:
    for row, axis in enumerate(axes):
        if axis.share is None:
            panel.text(0.0, row, " none", va="center", fontsize=7, style="italic", color=NEUTRAL)
            continue
        panel.barh(row, 100 * min(axis.share, ALL), height=0.72, color=COLORS["sky"])
        if axis.unique_share is not None:
            lost = min(axis.unique_share, ALL)
            panel.barh(row, 100 * lost, height=0.36, color=COLORS["blue"])
        both = (axis.share, axis.unique_share)
        told = (">100" if s > ALL else f"{100 * s:.0f}" for s in both if s is not None)
        percent = f" {' / '.join(told)}".replace("-", "−")
        end = min(max(axis.share, axis.unique_share or 0.0, 0.0), ALL)
        panel.text(100 * end, row, percent, va="center", fontsize=7)
    panel.axvline(0.0, color=COLORS["black"], linewidth=0.8)
    panel.set_yticks(range(len(axes)), [axis_label(axis.axis) for axis in axes])
    panel.set_ylim(max(len(axes), FEW_BARS) - 0.4, -0.6)
    seen = [s for axis in axes for s in (axis.share, axis.unique_share) if s is not None]
    each = [100 * min(share, ALL) for share in seen]
    least, most = min([0.0, *each]), max([10.0, *each])
    panel.set_xlim(1.1 * least, 1.3 * most)
    panel.grid(visible=False, axis="y")
    panel.set_xlabel("part of gap² explained [%]")


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
    panel.set_xlabel(with_unit(axis_label(axis.axis), axis.unit), fontsize=7.5, labelpad=1.5)


def what_acts(effects: Sequence[Inclusion], practical_share: float) -> Figure:
    """Draw how probable each effect is, and how strong.

    Parameters
    ----------
    effects : sequence of Inclusion
        The most probable first; the first eight are drawn.
    practical_share : float
        Of rms friction: what is below matters to nobody.
    """
    shown = [one for k, one in enumerate(effects) if k < FEWEST or one.probability > RARE]
    shown = shown[:EFFECTS]
    with figure(height=17.0 + 4.0 * max(len(shown), FEWEST)) as fig:
        left, right = fig.subplots(1, 2, sharey=True, width_ratios=(1, 1))
        for row, one in enumerate(shown):
            left.barh(row, one.probability, height=0.66, color=COLORS["blue"])
            label = left.text(one.probability + 0.02, row, stated(one.probability))
            label.set(va="center", fontsize=7, zorder=3)
            label.set_bbox({"facecolor": "white", "edgecolor": "none", "pad": 0.5})
            if one.strength is None:
                continue
            low, middle, high = (
                100 * q for q in (one.strength.q05, one.strength.q50, one.strength.q95)
            )
            faint = 1.0 if one.probability >= 0.5 else 0.4
            right.plot([low, high], [row, row], color=COLORS["blue"], linewidth=2.0, alpha=faint)
            right.plot(middle, row, "o", color=COLORS["blue"], alpha=faint)
        for mark in (0.1, 0.9):
            left.axvline(mark, color=NEUTRAL, linewidth=0.8, linestyle=":")
        right.axvline(100 * practical_share, color=COLORS["black"], linewidth=0.9, linestyle="--")
        left.set_yticks(range(len(shown)), [plain(one.effect) for one in shown])
        left.set_ylim(len(shown) - 0.4, -0.6)
        left.set_xlim(0.0, 1.25)
        left.set_xticks([0.0, 0.5, 1.0])
        left.set_xlabel("probability that it acts")
        right.set_xlim(left=0.0)
        right.set_xlabel("strength [% of friction]")
        for panel in (left, right):
            panel.grid(visible=False, axis="y")
        return fig


def axis_label(name: str) -> str:
    """Write the name of an axis, as in `axis_words`, for a figure."""
    return plain(axis_words(name))


def with_unit(words: str, unit: str) -> str:
    """Write a name with its unit in brackets, if it has one."""
    unit = UNITS.get(unit, unit)
    return f"{words} [{plain(unit)}]" if unit else words

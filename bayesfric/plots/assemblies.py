"""Trials and assemblies left out one at a time: probabilities, scores, and where they stand."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bayesfric.plots.labels import ordered_sizes, plain
from bayesfric.plots.rig_tables import rig_tables
from bayesfric.plots.style import (
    COLORS,
    NEUTRAL,
    NORMAL_90,
    area_key,
    figure,
    hollow,
    key,
    line_key,
    size_styles,
)


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


NAMED = 6  # far assemblies that carry their name
CROWD = 100  # points that are drawn small
CROWDED = 6  # conditions beyond which their names stand upright
CELL = ("n_pulleys", "wrap_angle_deg")


def has_assemblies(predictive: xr.DataTree) -> bool:
    """Tell whether any rig's assemblies were left out one at a time."""
    return any(rig.assemblies is not None for rig in rig_tables(predictive))


def assemblies_left_out(predictive: xr.DataTree) -> Figure:
    """Draw the assemblies of each rig against what all others predict of them.

    Parameters
    ----------
    predictive : DataTree
        ``predictive.nc`` with the assemblies of some rig.

    Returns
    -------
    Figure
        Of each rig: the distribution of the probabilities less the uniform one, with its band;
        scores over those expected of their rank, and those of its trials, each given the others
        of its assembly; scores by condition.
    """
    tables = [(rig, rig.assemblies) for rig in rig_tables(predictive) if rig.assemblies is not None]
    with figure(height=4.0 + 78.0 * len(tables)) as fig:
        grid = fig.add_gridspec(2 * len(tables), 6)
        for place, (rig, table) in enumerate(tables):
            title = plain(rig.title)
            own = rig.checks is not None and "score" in rig.checks
            wide = 2 if own else 3
            axes = fig.add_subplot(grid[2 * place, :wide])
            draw_probabilities(axes, table, title)
            axes.set_ylabel("share below it\nless the uniform")
            _ranked(
                fig.add_subplot(grid[2 * place, wide : 2 * wide]),
                table["z"],
                table["expected"],
                title,
                f"one {plain(rig.group)}",
            )
            if rig.checks is not None and own:
                of_trials = rig.checks["score"], rig.checks["score_expected"]
                axes = fig.add_subplot(grid[2 * place, 4:])
                _ranked(axes, *of_trials, title, f"a {plain(rig.trial)}")
            _by_condition(fig.add_subplot(grid[2 * place + 1, :]), table, title, plain(rig.group))
        keys = [
            line_key("this recording", color=COLORS["blue"], marker="o", markersize=3),
            area_key("95 % or 90 % by chance", 0.3),
            line_key("far beyond", color=COLORS["black"], linewidth=0.9, linestyle=":"),
        ]
        key(fig, keys, ncols=3)
        return fig


def _ranked(axes: Axes, score: xr.DataArray, expected: xr.DataArray, title: str, what: str) -> None:
    low, middle, high = expected.to_numpy().T
    axes.fill_between(middle, low, high, color=NEUTRAL, alpha=0.18, linewidth=0)
    axes.plot(middle, middle, color=NEUTRAL, linewidth=0.8)
    size = 3.0 if score.size < CROWD else 1.5
    axes.plot(middle, score.to_numpy(), "o", color=COLORS["blue"], markersize=size)
    axes.set_title(title)
    axes.set_xlabel("score expected of its rank")
    axes.set_ylabel(f"score of\n{what}")


def _by_condition(axes: Axes, table: xr.Dataset, title: str, what: str) -> None:
    z, names = table["z"].to_numpy(), table["assembly"].to_numpy()
    sizes = (
        [str(size) for size in table["pulley_size"].to_numpy()] if "pulley_size" in table else []
    )
    own = [tuple(float(table[c].to_numpy()[k]) for c in CELL if c in table) for k in range(z.size)]
    groups = ordered_sizes(sizes) or [title]
    sizes = sizes or [title] * z.size
    cells = sorted(set(zip(sizes, own, strict=True)), key=lambda c: (groups.index(c[0]), c[1]))
    several = len(cells) > 1
    place = np.array([cells.index(cell) for cell in zip(sizes, own, strict=True)])
    if not several:  # one condition of all says nothing: side by side, in their order
        place = np.arange(z.size)
    axes.axhspan(-NORMAL_90, NORMAL_90, color=NEUTRAL, alpha=0.15, linewidth=0)
    far = float(table["far"])
    for sign in (-1, 1):
        axes.axhline(sign * far, color=COLORS["black"], linewidth=0.9, linestyle=":")
    for size, look in size_styles(groups).items():
        of_size = np.array(sizes) == size
        axes.plot(
            place[of_size], z[of_size], look.marker, **hollow(look.color, 3.6, markeredgewidth=0.8)
        )
    beyond = np.flatnonzero(np.abs(z) > far)
    for k in beyond if beyond.size <= NAMED else ():
        axes.annotate(plain(str(names[k])), (place[k], z[k]), (5, -3), textcoords="offset points")
    written = [f"{plain(size)} " + ", ".join(f"{v:g}" for v in values) for size, values in cells]
    upright = 90 if len(cells) > CROWDED else 0
    if not several:
        written = [plain(str(name)) for name in names] if z.size <= CROWDED else []
    axes.set_xticks(range(len(written)), written, rotation=upright, fontsize=6.5)
    by = "by pulley size, number and wrap angle" if several else "in their order"
    axes.set_title(f"{title}: {by}")
    axes.set_ylabel(f"score of\none {what}")

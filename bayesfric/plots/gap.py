"""How far simulation and board are apart, before and after the causes are added."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.ticker import MaxNLocator

from bayesfric.plots.labels import plain, rounded
from bayesfric.plots.style import COLORS, figure, halves, key, line_key
from bayesfric.schemas.gap import Gap, GapRow

BARS = {
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
    numbers = {name: getattr(row, name, None) for name in BARS if name != "after" or named}
    shown = {name: number for name, number in numbers.items() if number is not None}
    for place, (name, number) in enumerate(shown.items()):
        words, color = BARS[name]
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

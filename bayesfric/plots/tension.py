"""Friction against nominal tension, as in the paper's Fig. 12."""

from dataclasses import replace

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from bayesfric.plots.labels import ordered_sizes, plain
from bayesfric.plots.live import Band, Chart, Curve, clouds_by_size, trial_words
from bayesfric.plots.rig_tables import rig_tables
from bayesfric.plots.style import (
    MARKERS,
    NEUTRAL,
    PAPER_LINE,
    SizeStyle,
    area_key,
    figure,
    hollow,
    key,
    line_key,
    size_styles,
)

ASIDE = 0.025  # of the greatest tension, between numbers of pulleys in the lower panels


def friction_against_tension(predictive: xr.DataTree, wrap_angle_deg: float) -> Figure:
    """Draw friction against nominal tension at one wrap angle, two panels a size.

    Parameters
    ----------
    predictive : DataTree
        ``predictive.nc`` with its groups ``trials`` and ``curves``.
    wrap_angle_deg : float
        Which angle.

    Returns
    -------
    Figure
        Above, trials by number of pulleys, the law's 5 % to 95 % band, and Table I.
        Below, the same relative to the law's median, with the 5 % to 95 % interval of
        a new trial on a new assembly behind each trial; numbers of pulleys stand side by
        side there.
    """
    trials = predictive["trials"].to_dataset()
    curves = predictive["curves"].to_dataset()
    trials = trials.isel(trial=np.flatnonzero(trials["wrap_angle_deg"] == wrap_angle_deg))
    curves = curves.isel(curve=np.flatnonzero(curves["wrap_angle_deg"] == wrap_angle_deg))
    sizes = ordered_sizes(curves["pulley_size"].to_numpy())
    styles = size_styles(sizes)
    counts = sorted({int(n) for n in trials["n_pulleys"].to_numpy()})
    markers = {n: MARKERS[place % len(MARKERS)] for place, n in enumerate(counts)}
    middle = (len(counts) - 1) / 2
    shifts = {n: ASIDE * (place - middle) for place, n in enumerate(counts)}
    top = float(curves["tension_n"].max())
    with figure(height=66.0) as fig:
        panels = fig.subplots(2, len(sizes), squeeze=False, sharex="col", height_ratios=[3, 2])
        for (above, below), size in zip(panels.T, sizes, strict=True):
            law = curves.isel(curve=np.flatnonzero(curves["pulley_size"] == size))
            points = trials.isel(trial=np.flatnonzero(trials["pulley_size"] == size))
            _draw_friction(above, law, styles[size])
            _draw_relative(below, law, styles[size])
            for n in counts:
                some = points.isel(trial=np.flatnonzero(points["n_pulleys"] == n))
                _draw_trials(above, below, some, shifts[n] * top, markers[n], styles[size])
            above.set_title(plain(size))
            above.set_xlim(left=0)
            above.set_ylim(bottom=0)
            below.set_xlabel("nominal tension [N]")
        panels[0, 0].set_ylabel("friction [N]")
        panels[1, 0].set_ylabel("deviation from\nthe law [%]")
        has_paper = bool(np.isfinite(curves["paper_n"].to_numpy()).any())
        keys = _keys(markers, has_paper)
        key(fig, keys, ncols=4)
        return fig


def tension_charts(predictive: xr.DataTree, wrap_angle_deg: float) -> list[Chart]:
    """Return friction against nominal tension at one wrap angle as one chart.

    Parameters
    ----------
    predictive : DataTree
        ``predictive.nc`` with its groups ``trials`` and ``curves``.
    wrap_angle_deg : float
        Which angle.
    """
    (rig,) = (rig for rig in rig_tables(predictive) if rig.id == "trial")
    upright = np.flatnonzero(rig.table["wrap_angle_deg"].to_numpy() == wrap_angle_deg)
    rig = replace(rig, table=rig.table.isel(trial=upright))
    curves = predictive["curves"].to_dataset()
    curves = curves.isel(curve=np.flatnonzero(curves["wrap_angle_deg"] == wrap_angle_deg))
    styles = size_styles(ordered_sizes(curves["pulley_size"].to_numpy()))
    columns, words = trial_words(rig, "N")
    tension = curves["tension_n"].to_numpy()
    lines, bands = [], []
    for place in range(curves.sizes["curve"]):
        size = str(curves["pulley_size"].to_numpy()[place])
        low, middle, high = curves["law_n"].isel(curve=place).to_numpy().T
        lines.append(Curve(size, styles[size].color, tension, middle))
        bands.append(Band(size, styles[size].color, tension, low, high))
    clouds = clouds_by_size(
        rig,
        styles,
        rig.table["tension_n"].to_numpy(),
        rig.table["friction_n"].to_numpy(),
        words,
        (rig.table["predicted_n"].to_numpy()[:, 0], rig.table["predicted_n"].to_numpy()[:, 2]),
    )
    return [
        Chart(
            title=f"Wrap angle {wrap_angle_deg:g}°; bars: new trials, 90 %",
            x_label="nominal tension [N]",
            y_label="friction [N]",
            columns=columns,
            clouds=clouds,
            curves=lines,
            bands=bands,
        )
    ]


def _draw_friction(axes: Axes, law: xr.Dataset, look: SizeStyle) -> None:
    """Draw the law of one size, a line and a band for each number of pulleys."""
    tension = law["tension_n"].to_numpy()
    for curve in range(law.sizes["curve"]):
        low, middle, high = law["law_n"].isel(curve=curve).to_numpy().T
        axes.fill_between(tension, low, high, color=look.color, alpha=0.35, linewidth=0)
        axes.plot(tension, middle, color=look.color, linewidth=0.9)
        _draw_paper(axes, tension, law["paper_n"].isel(curve=curve).to_numpy())


def _draw_relative(axes: Axes, law: xr.Dataset, look: SizeStyle) -> None:
    """Draw the law's own band and Table I, relative to the law's median."""
    tension = law["tension_n"].to_numpy()
    # Relative to its median the band hardly depends on n, so one stands for all.
    low, middle, high = law["law_n"].isel(curve=0).to_numpy().T
    axes.fill_between(
        tension,
        100 * (low / middle - 1),
        100 * (high / middle - 1),
        color=look.color,
        alpha=0.35,
        linewidth=0,
    )
    axes.axhline(0, color=look.color, linewidth=0.9)
    for curve in range(law.sizes["curve"]):
        middle = law["law_n"].isel(curve=curve).to_numpy()[:, 1]
        paper = law["paper_n"].isel(curve=curve).to_numpy()
        _draw_paper(axes, tension, 100 * (paper / middle - 1))


def _draw_trials(
    above: Axes, below: Axes, trials: xr.Dataset, shift: float, marker: str, look: SizeStyle
) -> None:
    """Draw trials of one number of pulleys, below with what new trials may do."""
    tension = trials["tension_n"].to_numpy()
    friction = trials["friction_n"].to_numpy()
    law = trials["law_n"].to_numpy()[:, 1]
    low, _, high = 100 * (trials["predicted_n"].to_numpy().T / law - 1)
    below.vlines(tension + shift, low, high, color=_pale(look.color), linewidth=2.4, zorder=1)
    for axes, places, values, width in (
        (above, tension, friction, 3.4),
        (below, tension + shift, 100 * (friction / law - 1), 2.4),
    ):
        axes.plot(
            places, values, marker, **hollow(look.color, width, markeredgewidth=0.8, zorder=3)
        )


def _pale(color: str) -> tuple[float, float, float]:
    """Return a light tint; unlike a transparent one, it does not darken where bars overlap."""
    red, green, blue = (0.3 * part + 0.7 for part in to_rgb(color))
    return red, green, blue


def _draw_paper(axes: Axes, tension: np.ndarray, values: np.ndarray) -> None:
    if np.isfinite(values).all():
        axes.plot(tension, values, **PAPER_LINE)


def _keys(markers: dict[int, str], has_paper: bool) -> list[Artist]:
    keys = [
        line_key(
            f"trial, n = {n}",
            marker=marker,
            linestyle="",
            **hollow(NEUTRAL, 3.6, markeredgewidth=0.8),
        )
        for n, marker in markers.items()
    ]
    keys.append(line_key("law, median", color=NEUTRAL, linewidth=0.9))
    keys.append(area_key("law, 5 % to 95 %", 0.5))
    keys.append(area_key("new trials, 5 % to 95 %", color=_pale(NEUTRAL)))
    if has_paper:
        keys.append(line_key("paper's law", **PAPER_LINE))
    return keys

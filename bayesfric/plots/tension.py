"""Friction against nominal tension, as in the paper's Fig. 12."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from bayesfric.plots.style import NEUTRAL, figure, size_styles

__all__ = ["friction_against_tension"]

MARKERS = "osD^vPX"


def friction_against_tension(predictive: xr.DataTree, wrap_angle_deg: float) -> Figure:
    """Draw friction against nominal tension at one wrap angle, a panel a size.

    Parameters
    ----------
    predictive : DataTree
        ``predictive.nc`` with its groups ``trials`` and ``curves``.
    wrap_angle_deg : float
        Which angle.

    Returns
    -------
    Figure
        Trials by number of pulleys, the law's 5 % to 95 % band, and Table I.
    """
    trials = predictive["trials"].to_dataset()
    curves = predictive["curves"].to_dataset()
    at_angle = trials.isel(trial=np.flatnonzero(trials["wrap_angle_deg"] == wrap_angle_deg))
    lines = curves.isel(curve=np.flatnonzero(curves["wrap_angle_deg"] == wrap_angle_deg))
    sizes = list(dict.fromkeys(str(size) for size in curves["pulley_size"].to_numpy()))
    sizes = [size for size in sizes if (at_angle["pulley_size"] == size).any()]
    styles = size_styles(sizes)
    counts = sorted({int(n) for n in at_angle["n_pulleys"].to_numpy()})
    markers = {n: MARKERS[place % len(MARKERS)] for place, n in enumerate(counts)}
    tension = lines["tension_n"].to_numpy()
    with figure(height=74.0) as fig:
        for place, size in enumerate(sizes):
            axes = fig.add_subplot(1, len(sizes), place + 1)
            look = styles[size]
            here = lines.isel(curve=np.flatnonzero(lines["pulley_size"] == size))
            for curve in range(here.sizes["curve"]):
                low, middle, high = here["law_n"].isel(curve=curve).to_numpy().T
                paper = here["paper_n"].isel(curve=curve).to_numpy()
                axes.fill_between(tension, low, high, color=look.color, alpha=0.3, linewidth=0)
                axes.plot(tension, middle, color=look.color, linewidth=0.9)
                if np.isfinite(paper).all():
                    axes.plot(tension, paper, color=NEUTRAL, linewidth=0.9, linestyle="--")
            points = at_angle.isel(trial=np.flatnonzero(at_angle["pulley_size"] == size))
            for n in counts:
                some = points.isel(trial=np.flatnonzero(points["n_pulleys"] == n))
                axes.plot(
                    some["tension_n"],
                    some["friction_n"],
                    markers[n],
                    color=look.color,
                    markersize=2.6,
                    markeredgewidth=0.3,
                    markeredgecolor="white",
                )
            axes.set_title(size)
            axes.set_xlim(left=0)
            axes.set_ylim(bottom=0)
            axes.set_xlabel("nominal tension [N]")
            if place == 0:
                axes.set_ylabel("friction [N]")
        keys = [
            Line2D([], [], color=NEUTRAL, marker=markers[n], linestyle="", label=f"n = {n}")
            for n in counts
        ]
        keys.append(Line2D([], [], color=NEUTRAL, linestyle="--", label="Table I"))
        fig.legend(handles=keys, loc="outside lower center", ncols=len(keys))
        return fig

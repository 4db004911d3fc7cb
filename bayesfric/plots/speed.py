"""Friction at constant speeds, as in the paper's Figs 4 to 7."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bayesfric.plots.labels import ordered_sizes
from bayesfric.plots.rig_tables import RigTable
from bayesfric.plots.style import MARKERS, figure, size_styles

VARIED = (
    ("hanging_mass_kg", "{:g} kg", "weight"),
    ("wrap_angle_deg", "{:g}°", "wrap angle"),
    ("n_pulleys", "n = {:g}", "pulleys"),
)
HEADROOM = 1.6  # above the data, for the legend


def _condition(axes: Axes, runs: xr.Dataset, marker: str, color: str, label: str) -> None:
    """Draw the runs of a condition, and the band of new runs."""
    runs = runs.sortby("velocity_m_s")
    speed, (low, _, high) = runs["velocity_m_s"].to_numpy(), runs["predicted_n"].to_numpy().T
    axes.fill_between(speed, low, high, color=color, alpha=0.25, linewidth=0)
    axes.plot(speed, runs["friction_n"], marker, color=color, markersize=2.4, label=label)


def _legend(axes: Axes) -> None:
    """Put the key above the data, and leave it room there."""
    low, high = axes.get_ylim()
    axes.set_ylim(bottom=min(0.0, low), top=HEADROOM * high)
    legend = axes.legend(
        loc="upper left",
        ncols=3,
        fontsize=6,
        columnspacing=0.5,
        handletextpad=0.0,
        handlelength=1.2,
        borderpad=0.1,
    )
    legend.set_in_layout(False)


def has_speeds(rig: RigTable) -> bool:
    """Tell whether each trial of a rig was measured at one speed."""
    return {"velocity_m_s", *(name for name, _, _ in VARIED)} <= set(rig.table.data_vars)


def friction_against_speed(rig: RigTable) -> Figure:
    """Draw friction against speed: a row for what varies, a column for each size.

    Parameters
    ----------
    rig : RigTable
        Of a rig that :func:`has_speeds`.

    Returns
    -------
    Figure
        Runs, and the 5 % to 95 % band of a new run on a new assembly. A row holds
        the conditions that differ in one thing from the size's most frequent one.
    """
    runs = rig.table
    size_column = np.array(rig.sizes)
    sizes = ordered_sizes(sorted(rig.sizes))
    styles = size_styles(sizes)
    columns = {name: runs[name].to_numpy() for name, _, _ in VARIED}
    with figure(height=38.0 * len(VARIED)) as fig:
        panels = fig.subplots(len(VARIED), len(sizes), squeeze=False)
        for column, size in enumerate(sizes):
            of_size = size_column == size
            usual = {name: _most_frequent(values[of_size]) for name, values in columns.items()}
            for row, (varied, text, title) in enumerate(VARIED):
                axes = panels[row, column]
                alike = of_size.copy()
                for name, values in columns.items():
                    if name != varied:
                        alike &= values == usual[name]
                for place, value in enumerate(np.unique(columns[varied][alike])):
                    some = runs.isel({rig.id: np.flatnonzero(alike & (columns[varied] == value))})
                    marker = MARKERS[place % len(MARKERS)]
                    _condition(axes, some, marker, styles[size].color, text.format(value))
                _legend(axes)
                if row == 0:
                    axes.set_title(size)
                if row == len(VARIED) - 1:
                    axes.set_xlabel("speed [m/s]")
                if column == 0:
                    axes.set_ylabel(f"friction [N]\nby {title}")
        return fig


def _most_frequent(values: np.ndarray) -> float:
    distinct, counts = np.unique(values, return_counts=True)
    return float(distinct[counts.argmax()])

"""Drive forces of held-out runs: measured, and as a model asks for them with either values."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from bayesfric.plots.labels import plain
from bayesfric.plots.style import COLORS, figure, key

ROW_MM, REST_MM = 30.0, 16.0
MOST = 4  # joints that are drawn
ARMS = {
    "measured_n": ("measured", COLORS["black"], "-", 1.4),
    "as_is_n": ("your model as it is", COLORS["vermilion"], "--", 1.1),
    "proposed_n": ("with the proposed values", COLORS["blue"], "-", 0.8),
}


def replayed_forces(traces: xr.Dataset, unit: str) -> Figure:
    """Draw a panel a joint, of four at the most.

    Parameters
    ----------
    traces : Dataset
        Group ``replay`` of ``diagnosis.nc``.
    unit : str
        Of the forces.
    """
    names = [str(name) for name in traces["joint"].to_numpy()][:MOST]
    time = np.asarray(traces["time_s"].to_numpy())
    with figure(height=ROW_MM * len(names) + REST_MM) as fig:
        panels = np.reshape(fig.subplots(len(names), 1, sharex=True), -1)
        for place, (panel, name) in enumerate(zip(panels, names, strict=True)):
            for arm, (label, color, line, width) in ARMS.items():
                values = traces[arm].to_numpy()[place]
                panel.plot(time, values, color=color, linestyle=line, linewidth=width, label=label)
            panel.set_ylabel(f"{plain(name)} [{unit}]")
        panels[-1].set_xlabel("time in a held-out run [s]")
        key(fig, panels[0].get_legend_handles_labels()[0], ncols=len(ARMS))
    return fig

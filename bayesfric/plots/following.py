"""How far the joint is behind references that move, with each compensator."""

import numpy as np
from matplotlib.figure import Figure

from bayesfric.plots.style import COLORS, LINES, NEUTRAL, figure, key
from bayesfric.schemas.loop_runs import Following

SHADES = tuple(COLORS[name] for name in ("black", "blue", "vermilion", "green", "purple", "orange"))

DASHES = (*LINES, (0, (8, 2)), (0, (4, 1, 1, 1, 1, 1)))


def errors_over_time(following: Following) -> Figure:
    """Draw the error at the tip over time: medians, and 5 to 95 % of none and of the best.

    Parameters
    ----------
    following : Following
        A panel a trajectory, a colour a compensator; what is judged is shaded.
    """
    time = np.array(following.time_s)
    with figure(height=120.0) as fig:
        fig.suptitle("Which compensator leaves least error at the tip?", fontsize=9.0)
        panels = fig.subplots(2, 2, sharex=True).ravel()
        for axes, trajectory in zip(panels, following.trajectories, strict=True):
            axes.axvspan(following.settling_s, time[-1], color=NEUTRAL, alpha=0.1, linewidth=0)
            axes.axhline(0, color=NEUTRAL, linewidth=0.5)
            for compensator, color, line in zip(
                trajectory.compensators, SHADES, DASHES, strict=True
            ):
                low, middle, high = (
                    1e3 * np.array(band)
                    for band in (compensator.q05_m, compensator.q50_m, compensator.q95_m)
                )
                if compensator.compensator in (
                    "none",
                    *trajectory.best,
                ):  # more bands would hide each other
                    axes.fill_between(time, low, high, color=color, alpha=0.15, linewidth=0)
                    for edge in (low, high):
                        axes.plot(time, edge, color=color, linestyle=line, linewidth=0.4)
                axes.plot(time, middle, color=color, linestyle=line, linewidth=1.0,
                          label=compensator.compensator)  # fmt: skip
            axes.set_title(f"{trajectory.name}: {' or '.join(trajectory.best)}")
        for axes in panels[2:]:
            axes.set_xlabel("time since the reference set off [s]")
        for axes in panels[::2]:
            axes.set_ylabel("behind at the tip [mm]")
        key(fig, panels[0].get_legend_handles_labels()[0], ncols=3)
    return fig

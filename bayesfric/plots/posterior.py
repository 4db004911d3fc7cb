"""Posteriors of the coefficients: all nine at once, and pairs for one size."""

import warnings

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from bayesfric.plots.style import COLORS, NEUTRAL, TEXT_WIDTH, figure, size_styles

__all__ = ["coefficient_pairs", "coefficients_relative_to_paper"]

SHOWN_DRAWS = 4000  # more points would not change the contours
PRINTED = {"c1": (1e3, "c1 [10⁻³]"), "c2": (1e3, "c2 [mN]"), "c3": (1e6, "c3 [10⁻⁶/deg]")}


def coefficients_relative_to_paper(predictive: xr.DataTree) -> Figure:
    """Draw each coefficient as a ratio to Table I.

    Parameters
    ----------
    predictive : DataTree
        ``predictive.nc`` with its group ``coefficients``.

    Returns
    -------
    Figure
        A row for each coefficient and size: median, 50 % and 90 % intervals.
    """
    table = predictive["coefficients"].to_dataset()
    sizes = [str(size) for size in table["pulley"].to_numpy()]
    styles = size_styles(sizes)
    with figure(height=14.0 + 5.2 * table["ratio"].isel(level=0).size) as fig:
        axes = fig.subplots()
        labels, rows = [], []
        row = 0
        for coefficient in table["coefficient"].to_numpy():
            for size in sizes:
                ratio = table["ratio"].sel(coefficient=coefficient, pulley=size).to_numpy()
                look = styles[size]
                axes.plot(ratio[[0, 4]], [row, row], color=look.color, linewidth=1.2)
                axes.plot(ratio[[1, 3]], [row, row], color=look.color, linewidth=4.0)
                axes.plot(
                    ratio[2], row, look.marker, color="white", markeredgecolor=look.color, zorder=3
                )
                labels.append(f"{coefficient} {size}")
                rows.append(row)
                row += 1
            row += 1
        axes.axvline(1.0, color=NEUTRAL, linewidth=0.9, linestyle="--")
        axes.set_yticks(rows, labels)
        axes.invert_yaxis()
        axes.grid(visible=False, axis="y")
        axes.set_xlabel("posterior / value in Table I (thick: 50 %, thin: 90 %)")
        return fig


def coefficient_pairs(draws: xr.DataTree, size: str, paper: dict[str, float] | None) -> Figure:
    """Draw the joint posterior of c1, c2, c3 of one size.

    Parameters
    ----------
    draws : DataTree
        ``draws.nc``.
    size : str
        The pulley size.
    paper : dict of str to float or None
        Table I's values, to be marked; None where it has no such size.

    Returns
    -------
    Figure
        Histograms, and contours that hold 39.3 % and 86.5 % of the draws: the one-
        and two-sigma regions of a two-dimensional normal.
    """
    posterior = draws["posterior"].to_dataset()
    points = np.stack(
        [
            scale * posterior[name].sel(pulley=size).to_numpy().ravel()
            for name, (scale, _) in PRINTED.items()
        ],
        axis=1,
    )
    points = points[:: max(1, len(points) // SHOWN_DRAWS)]
    look = size_styles([size])[size]
    with warnings.catch_warnings(), figure(height=0.72 * TEXT_WIDTH, constrained=False) as fig:
        warnings.simplefilter("ignore", FutureWarning)  # arviz, which corner imports
        import corner

        corner.corner(
            points,
            fig=fig,
            bins=30,
            labels=[label for _, label in PRINTED.values()],
            truths=paper and [scale * paper[name] for name, (scale, _) in PRINTED.items()],
            truth_color=COLORS["black"],
            color=look.color,
            levels=(1 - np.exp(-0.5), 1 - np.exp(-2.0)),
            plot_datapoints=False,
            smooth=1.0,
            max_n_ticks=3,
            labelpad=0.05,
            hist_kwargs={"linewidth": 1.0},
            label_kwargs={"fontsize": 8},
        )
        for axes in fig.axes:
            axes.grid(visible=False)
            axes.tick_params(axis="both", labelrotation=0)
        fig.subplots_adjust(left=0.16, bottom=0.17, right=0.98, top=0.98, wspace=0.12, hspace=0.12)
        return fig

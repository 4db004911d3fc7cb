"""Posteriors of the coefficients: all of them at once, and pairs for one size."""

import warnings
from collections.abc import Collection, Mapping

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from bayesfric.arrays import Array
from bayesfric.plots.labels import parameter_label, plain, rounded
from bayesfric.plots.live import Chart, Cloud, Curve
from bayesfric.plots.style import (
    COLORS,
    NEUTRAL,
    TEXT_WIDTH,
    SizeStyle,
    figure,
    hollow,
    line_key,
    size_styles,
)

SHOWN_DRAWS = 4000  # more points would not change the contours
PAIRS_SHARE = 0.75
"""Width of the figure of pairs as a share of the text's."""

Quantiles = Mapping[str, tuple[float, float, float]]
"""5 %, 50 % and 95 % quantile of each coefficient."""

PRINTED = {
    "c1": (1e3, "$c_1$ [10⁻³]"),
    "c2": (1e3, "$c_2$ [10⁻³ N]"),
    "c3": (1e6, "$c_3$ [10⁻⁶ deg⁻¹]"),
}

LOWERED = str.maketrans("123", "₁₂₃")  # of c1, as the text has it


def coefficients_relative_to_paper(
    predictive: xr.DataTree,
    uninformed: Collection[str] = (),
    refitted: Quantiles | None = None,
) -> Figure:
    """Draw each coefficient as a ratio to Table I.

    Parameters
    ----------
    predictive : DataTree
        ``predictive.nc`` with its group ``coefficients``.
    uninformed : collection of str
        Coefficients, such as ``c3[small]``, that the recording does not inform. Their
        rows say so: intervals as wide as a prior would leave no room for the others.
    refitted : mapping of str to tuple of three floats, optional
        5 %, 50 % and 95 % quantiles of coefficients that were refitted with the named causes.
        They have the colours then, and the law alone is grey.

    Returns
    -------
    Figure
        A row for each coefficient and size: median, 50 % and 90 % intervals.
    """
    table = predictive["coefficients"].to_dataset()
    sizes = [str(size) for size in table["pulley"].to_numpy()]
    styles = size_styles(sizes)
    refitted = refitted or {}
    grey = SizeStyle(NEUTRAL, "o")
    with figure(height=13.0 + 3.5 * table["ratio"].isel(level=0).size) as fig:
        axes = fig.subplots()
        labels, rows = [], []
        row = 0
        for coefficient in table["coefficient"].to_numpy():
            for size in sizes:
                ratio = table["ratio"].sel(coefficient=coefficient, pulley=size).to_numpy()
                name = f"{coefficient}[{size}]"
                look = grey if name in refitted else styles[size]
                if name in uninformed:
                    _not_informed(axes, row)
                else:
                    _bar(axes, ratio[[0, 2, 4]], row, look)
                    axes.plot(ratio[[1, 3]], [row, row], color=look.color, linewidth=3.6)
                if name in refitted:
                    paper = float(table["paper"].sel(coefficient=coefficient, pulley=size))
                    _bar(axes, np.array(refitted[name]) / paper, row - 0.35, styles[size])
                labels.append(parameter_label(name))
                rows.append(row)
                row += 1
            row += 1
        axes.axvline(1.0, color=COLORS["black"], linewidth=0.9, linestyle="--", zorder=1)
        axes.set_yticks(rows, labels)
        axes.set_ylim(row - 1.4, -0.6)
        axes.grid(visible=False, axis="y")
        axes.set_xlabel("posterior / the paper's value (thick: 50 %, thin: 90 %)")
        return fig


def _not_informed(axes: Axes, row: float) -> None:
    words, grey = "  not informed by this recording", NEUTRAL
    axes.text(1.0, row, words, color=grey, fontsize=7, verticalalignment="center")


def _bar(axes: Axes, quantiles: Array, row: float, look: SizeStyle) -> None:
    """Draw a 90 % interval with its median."""
    axes.plot(quantiles[[0, 2]], [row, row], color=look.color, linewidth=1.2)
    axes.plot(quantiles[1], row, look.marker, **hollow(look.color, 3.4, zorder=3))


def ratio_charts(
    predictive: xr.DataTree,
    uninformed: Collection[str] = (),
    refitted: Quantiles | None = None,
) -> list[Chart]:
    """Return each informed coefficient as a ratio to Table I, as one chart.

    Parameters
    ----------
    predictive, uninformed, refitted
        As of :func:`coefficients_relative_to_paper`; a refitted one stands alone.
    """
    table = predictive["coefficients"].to_dataset()
    sizes = [str(size) for size in table["pulley"].to_numpy()]
    names = [str(name) for name in table["coefficient"].to_numpy()]
    rows = [(name, size) for name in names for size in sizes if f"{name}[{size}]" not in uninformed]
    clouds = []
    for size, look in size_styles(sizes).items():
        places = [place for place, row in enumerate(rows) if row[1] == size]
        if not places:
            continue
        ratios, said = [], []
        for name, _ in (rows[place] for place in places):
            at = table.sel(coefficient=name, pulley=size)
            value = at["value"].to_numpy()[[0, 2, 4]]
            if refitted and f"{name}[{size}]" in refitted:
                value = np.array(refitted[f"{name}[{size}]"])
            ratio = value / float(at["paper"])
            ratios.append(ratio)
            said.append(
                [
                    f"{name.translate(LOWERED)} {size}",
                    f"{rounded(ratio[1], ratio[0], ratio[2])} "
                    f"({rounded(ratio[0], ratio[0], ratio[2])} to "
                    f"{rounded(ratio[2], ratio[0], ratio[2])})",
                    f"{value[1]:.3g}",
                    f"{float(at['paper']):.3g}",
                ]
            )
        low, middle, high = np.transpose(ratios)
        y = np.array(places, dtype=float)
        clouds.append(Cloud(size, look.color, look.marker, middle, y, low, high, said))
    line = np.array([-0.6, len(rows) - 0.4])
    return [
        Chart(
            title="Median and 90 % interval",
            x_label="posterior / the paper's value",
            y_label="",
            columns=["coefficient", "over the paper's, 90 %", "median", "the paper's"],
            clouds=clouds,
            curves=[Curve("", COLORS["black"], np.ones(2), line, dashed=True)],
            rows=[f"{name.translate(LOWERED)} {size}" for name, size in rows],
        )
    ]


def coefficient_pairs(draws: xr.DataTree, size: str, paper: dict[str, float] | None) -> Figure:
    """Draw the joint posterior of c1, c2, c3 of one size, or of those of them that it has.

    Parameters
    ----------
    draws : DataTree
        ``draws.nc``.
    size : str
        The pulley size.
    paper : dict of str to float or None
        Table I's values, to be marked; None where it has no such size. A value that
        is further from the draws than they span is named in the legend instead.

    Returns
    -------
    Figure
        Histograms, and contours that hold 39.3 % and 86.5 % of the draws: the one-
        and two-sigma regions of a two-dimensional normal.
    """
    posterior = draws["posterior"].to_dataset()
    printed = {name: how for name, how in PRINTED.items() if name in posterior}
    points = np.stack(
        [
            scale * posterior[name].sel(pulley=size).to_numpy().ravel()
            for name, (scale, _) in printed.items()
        ],
        axis=1,
    )
    points = points[:: max(1, len(points) // SHOWN_DRAWS)]
    marks = [None if paper is None else scale * paper[name] for name, (scale, _) in printed.items()]
    ranges = [_range(column, mark) for column, mark in zip(points.T, marks, strict=True)]
    shown = [
        mark if mark is not None and low < mark < high else None
        for mark, (low, high) in zip(marks, ranges, strict=True)
    ]
    color = size_styles([size])[size].color
    with figure(PAIRS_SHARE * TEXT_WIDTH, 56.0, room=False) as fig:
        _corner(fig, points, ranges, [label for _, label in printed.values()], shown, color)
        for axes in fig.axes:
            axes.grid(visible=False)
            for axis in (axes.xaxis, axes.yaxis):
                if len(axis.get_ticklocs()):
                    axis.set_major_locator(MaxNLocator(3, prune="both"))
            axes.tick_params(axis="both", labelrotation=0)
            axes.xaxis.set_label_coords(0.5, -0.36)
            axes.set_ylabel(axes.get_ylabel().replace(" [", "\n["))  # low panels, long units
            axes.yaxis.set_label_coords(-0.38, 0.5)
        fig.subplots_adjust(left=0.15, bottom=0.17, right=0.98, top=0.98, wspace=0.1, hspace=0.1)
        fig.legend(
            handles=_keys(color, list(printed), shown, marks),
            loc="upper right",
            bbox_to_anchor=(0.98, 0.98),
            title=f"{plain(size)} pulley",
            title_fontsize=8.5,
            alignment="left",
        )
        return fig


def _corner(
    fig: Figure,
    points: np.ndarray,
    ranges: list[tuple[float, float]],
    labels: list[str],
    marks: list[float | None],
    color: str,
) -> None:
    """Draw histograms and contours of points, shape (N, coefficients), and lines at marks."""
    with warnings.catch_warnings():
        # Of ArviZ 0.23, which corner imports where it is installed.
        warnings.simplefilter("ignore", FutureWarning)
        import corner

        corner.corner(
            points,
            fig=fig,
            bins=30,
            range=ranges,
            labels=labels,
            color=color,
            levels=(1 - np.exp(-0.5), 1 - np.exp(-2.0)),
            plot_datapoints=False,
            plot_density=False,
            fill_contours=True,
            smooth=1.0,
            contour_kwargs={"linewidths": 0.9},
            hist_kwargs={"linewidth": 1.0},
            label_kwargs={"fontsize": 8},
        )
        lines = {"color": COLORS["black"], "linewidth": 0.9, "linestyle": "--", "zorder": 5}
        corner.overplot_lines(fig, marks, **lines)


def _range(draws: np.ndarray, mark: float | None) -> tuple[float, float]:
    """Return the draws' range, widened to hold a mark that is not far from it."""
    low, high = float(draws.min()), float(draws.max())
    margin = 0.02 * (high - low)
    low, high = low - margin, high + margin
    if mark is not None and low - (high - low) < mark < high + (high - low):
        low, high = min(low, mark - margin), max(high, mark + margin)
    return low, high


def _keys(
    color: str, names: list[str], shown: list[float | None], marks: list[float | None]
) -> list[Artist]:
    keys: list[Artist] = [
        Patch(color=color, alpha=0.8, label="holds 39 % of the draws"),
        Patch(color=color, alpha=0.4, label="holds 86 % of the draws"),
    ]
    if any(mark is not None for mark in shown):
        keys.append(line_key("paper", color=COLORS["black"], linewidth=0.9, linestyle="--"))
    for name, seen, mark in zip(names, shown, marks, strict=True):
        if mark is not None and seen is None:
            text = f"paper beyond the panel: {parameter_label(name)} = {mark:.4g}"
            keys.append(Patch(color="none", label=text))
    return keys

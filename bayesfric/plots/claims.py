"""Bayes factors of the paper's claims: against each rival, and over the priors' width."""

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from bayesfric.plots.labels import numbers
from bayesfric.plots.style import COLORS, LINES, MARKERS, NEUTRAL, SHADES, figure, key

FURTHEST = 8.0  # log10; what lies beyond is drawn there, with an arrow


def over_prior_width(curves: xr.DataTree, support: float, refute: float) -> Figure:
    """Draw log10 Bayes factors over the width of the rivals' priors, a line a claim.

    Parameters
    ----------
    curves : DataTree
        Of ``claims.nc``; group ``curves``.
    support, refute : float
        Thresholds, drawn as lines.
    """
    table = curves["curves"].to_dataset()
    width = table["width"].to_numpy()
    values = np.clip(table["log10_bayes_factor"].to_numpy(), -FURTHEST, FURTHEST)
    with figure(height=48.0) as fig:
        axes = fig.subplots()
        for place, name in enumerate(table["claim"].to_numpy()):
            axes.plot(
                width,
                values[place],
                color=SHADES[place % len(SHADES)],
                linestyle=LINES[place % len(LINES)],
                marker=MARKERS[place % len(MARKERS)],
                markevery=5,
                markersize=3.2,
                linewidth=1.0,
                label=str(name),
            )
        axes.axhline(support, color=NEUTRAL, linewidth=0.8, linestyle="--", zorder=1)
        axes.axhline(refute, color=NEUTRAL, linewidth=0.8, linestyle=":", zorder=1)
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter(numbers())
        axes.xaxis.set_minor_locator(NullLocator())
        axes.set_xlabel("width of the rivals' priors, relative to the analysis")
        axes.set_ylabel("log₁₀ Bayes factor")
        key(fig, axes.get_legend_handles_labels()[0], ncols=3)
    return fig


def against_rivals(factors: Mapping[str, Mapping[str, float]]) -> Figure:
    """Draw the log10 Bayes factor of each claim against each of its rivals.

    Parameters
    ----------
    factors : mapping of str to mapping of str to float
        Claim to rival to log10 Bayes factor in favour of the claim.
    """
    rows = sum(len(rivals) for rivals in factors.values())
    with figure(height=14.0 + 2.9 * (rows + len(factors))) as fig:
        axes = fig.subplots()
        row, ticks, labels = 0, [], []
        for place, (claim, rivals) in enumerate(factors.items()):
            axes.text(-FURTHEST * 1.02, row, claim, fontsize=7.5, fontweight="bold", va="center")
            row += 1
            for rival, value in rivals.items():
                shown = float(np.clip(value, -FURTHEST, FURTHEST))
                axes.plot([0, shown], [row, row], color=SHADES[place % len(SHADES)], linewidth=1.2)
                marker = "o" if shown == value else (">" if value > 0 else "<")
                axes.plot(shown, row, marker, color=SHADES[place % len(SHADES)], markersize=3.8)
                if shown != value:
                    axes.text(
                        shown * 0.93,
                        row,
                        f"{value:.0f}".replace("-", "−"),
                        fontsize=6.5,
                        ha="right" if shown > 0 else "left",
                        va="center",
                        bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.6},
                    )
                ticks.append(row)
                labels.append(rival)
                row += 1
        axes.axvline(0.0, color=COLORS["black"], linewidth=0.8)
        axes.set_yticks(ticks, labels)
        axes.set_ylim(row - 0.4, -0.8)
        axes.set_xlim(-1.06 * FURTHEST, 1.06 * FURTHEST)
        axes.set_xlabel("log₁₀ Bayes factor in favour of the claim")
    return fig


def smallest_found(shares: Mapping[str, Mapping[str, float]], matters: float) -> Figure:
    """Draw the smallest effect that would have been found, a dot for each rival of a claim.

    Parameters
    ----------
    shares : mapping of str to mapping of str to float
        Claim to rival to share of friction.
    matters : float
        Share from which on an effect matters, drawn as a line.
    """
    rows = [(claim, rival, share) for claim, own in shares.items() for rival, share in own.items()]
    claims = list(shares)
    with figure(height=16.0 + 2.9 * len(rows)) as fig:
        axes = fig.subplots()
        for row, (claim, _, share) in enumerate(rows):
            shade = SHADES[claims.index(claim) % len(SHADES)]
            axes.plot(100 * share, row, "o", color=shade, markersize=4.0)
        axes.axvline(100 * matters, color=NEUTRAL, linewidth=0.8, linestyle="--", zorder=1)
        axes.set_xscale("log")
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.xaxis.set_major_formatter(numbers())
        axes.xaxis.set_minor_locator(NullLocator())
        axes.set_yticks(range(len(rows)), [f"{claim}: {rival}" for claim, rival, _ in rows])
        axes.set_ylim(len(rows) - 0.4, -0.6)
        axes.set_xlabel("smallest effect found with probability 0.9 [% of friction]")
    return fig

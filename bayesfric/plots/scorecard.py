"""The scorecard of the diagnosis on data whose effect is withheld."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bayesfric.plots.labels import plain
from bayesfric.plots.style import COLORS, NEUTRAL, figure, halves, name_rows
from bayesfric.schemas import ScorecardFile
from bayesfric.schemas.scorecard import Confusion, Detected, ReliabilityBin, Target

ROW_MM = 4.4
LOW_MM = 44.0  # of the height where few promises have cases, so that little of it is empty
SQUARE_MM = 66.0  # of the height at which the reliability diagram is about as wide as high
OUTCOMES = {"kept": COLORS["green"], "missed": COLORS["vermilion"]}  # others: too few to tell
CASES_TO_DRAW = 10  # of a promise
FEWEST_TO_DRAW = 3  # promises of so many cases; fewer leave the figure empty
FEWEST = 4  # rows of promises for which there is room at least
PALE = 0.6  # share of a row from which on black is not legible on blue
SMALLEST_DOT, LARGEST_DOT = 3.0, 9.0  # of a bin with few and with many cases


def drawn_promises(card: ScorecardFile) -> tuple[Target, ...]:
    """Return the promises that are drawn: of fewer cases an interval covers most of the axis.

    Parameters
    ----------
    card : ScorecardFile
        ``scorecard.json``.
    """
    return tuple(target for target in card.targets if target.rate.cases >= CASES_TO_DRAW)


def promises_and_reliability(card: ScorecardFile) -> Figure:
    """Draw rates with intervals against what was promised, and the reliability diagram.

    Parameters
    ----------
    card : ScorecardFile
        ``scorecard.json``.

    Returns
    -------
    Figure
        Left a row a promise of enough cases: the rate, its 95 % interval, and the range that is
        promised; right how often verdicts were correct over the probability that they reported.
    """
    tried = drawn_promises(card)
    least = SQUARE_MM if len(tried) > FEWEST else LOW_MM
    with figure(height=max(least, 18.0 + ROW_MM * len(tried))) as fig:
        left, right = halves(fig, 8, 5)
        _promises(left.subplots(), tried)
        _reliability(right.subplots(), card.reliability)
        return fig


def _promises(panel: Axes, targets: tuple[Target, ...]) -> None:
    names = []
    for place, target in enumerate(targets):
        names.append(target.name)
        low = 0.0 if target.at_least is None else 100 * target.at_least
        high = 100.0 if target.at_most is None else 100 * target.at_most
        panel.barh(place, high - low, left=low, height=0.8, color="#dcebf5", zorder=1)
        rate = target.rate
        assert rate.rate is not None
        color, mark = OUTCOMES.get(target.outcome, NEUTRAL), "X" if target.met is False else "o"
        panel.plot([100 * rate.low, 100 * rate.high], [place, place], color=color, linewidth=1.6)
        panel.plot(100 * rate.rate, place, mark, color=color, markersize=5, clip_on=False)
        panel.text(
            108, place, f"{rate.hits}/{rate.cases}", va="center", fontsize=6.5, clip_on=False
        )
    name_rows(panel, names, room=FEWEST, size=7)
    panel.set_xlim(-2.0, 102.0)
    panel.set_xlabel("rate [%]; shaded: promised")


def _reliability(panel: Axes, bins: tuple[ReliabilityBin, ...]) -> None:
    panel.plot([0, 1], [0, 1], color=NEUTRAL, linewidth=0.8, zorder=1)
    most = max((scored.cases for scored in bins), default=1)
    for scored in bins:
        assert scored.correct.rate is not None
        x, color = scored.probability, COLORS["blue"] if scored.inside else COLORS["vermilion"]
        panel.plot([x, x], list(scored.band), color="#c9c9c9", linewidth=6, solid_capstyle="butt")
        size = SMALLEST_DOT + (LARGEST_DOT - SMALLEST_DOT) * np.sqrt(scored.cases / most)
        marker = "o" if scored.inside else "X"
        panel.plot(x, scored.correct.rate, marker, color=color, markersize=size, clip_on=False)
    panel.set_xlim(0.0, 1.02)
    panel.set_ylim(-0.02, 1.02)
    panel.set_xlabel("probability of the verdict")
    panel.set_ylabel("share that came true")
    panel.set_title("grey: 95 % band if they are true", fontsize=7)


def confusion_matrix(confusion: Confusion) -> Figure:
    """Draw what was withheld against what was said, shares of a row as shades.

    Parameters
    ----------
    confusion : Confusion
        Of ``scorecard.json``.
    """
    shown = [k for k, row in enumerate(confusion.counts) if sum(row)]
    counts = np.array([confusion.counts[k] for k in shown], dtype=np.float64)
    counts = counts.reshape(len(shown), len(confusion.columns))
    rows = [confusion.rows[k] for k in shown]
    with figure(height=34.0 + ROW_MM * len(rows)) as fig:
        panel = fig.subplots()
        share = counts / counts.sum(axis=1, keepdims=True)
        panel.imshow(share, cmap="Blues", vmin=0.0, vmax=1.3, aspect="auto")
        for (row, column), count in np.ndenumerate(counts):
            if count:
                right = rows[row] == confusion.columns[column]
                weight = "bold" if right else "normal"
                panel.text(
                    column,
                    row,
                    f"{count:.0f}",
                    ha="center",
                    va="center",
                    fontsize=6,
                    weight=weight,
                    color="black" if share[row, column] < PALE else "white",
                )
        panel.set_xticks(range(len(confusion.columns)), [plain(c) for c in confusion.columns])
        panel.tick_params(axis="x", rotation=90, labelsize=6.5)
        panel.set_yticks(range(len(rows)), [plain(name) for name in rows], fontsize=6.5)
        panel.set_xlabel("verdict")
        panel.set_ylabel("withheld")
        panel.grid(visible=False)
        return fig


def named_by_strength(detected: Mapping[str, Detected]) -> Figure:
    """Draw how often effects were named, by the strengths that were tried.

    Parameters
    ----------
    detected : mapping of Detected
        By effect, of ``scorecard.json``.
    """
    strengths = sorted(
        {float(s) for strengths_tried in detected.values() for s in strengths_tried.tried}
    )
    columns = {strength: place for place, strength in enumerate(strengths)}
    with figure(height=20.0 + ROW_MM * len(detected)) as fig:
        panel = fig.subplots()
        for row, effect in enumerate(detected.values()):
            for strength, rate in effect.tried.items():
                if rate.rate is None:
                    continue
                size = SMALLEST_DOT + min(rate.cases, LARGEST_DOT - SMALLEST_DOT)
                panel.plot(columns[float(strength)], row, "o", markersize=size,
                           markerfacecolor=str(1 - rate.rate), markeredgecolor="black",
                           markeredgewidth=0.7)  # fmt: skip
                if rate.cases > 1:
                    panel.text(columns[float(strength)] + 0.1, row, f"{rate.hits}/{rate.cases}",
                               va="center", fontsize=6)  # fmt: skip
        panel.set_xticks(range(len(strengths)), [f"{strength:g}" for strength in strengths])
        panel.set_xlim(-0.5, len(strengths) - 0.5)
        panel.set_yticks(range(len(detected)), [plain(name) for name in detected], fontsize=6.5)
        panel.set_ylim(len(detected) - 0.4, -0.6)
        panel.set_xlabel("strength (1 is 10 % of friction)")
        return fig

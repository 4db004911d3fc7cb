"""Where the simulation misses the board, which effect causes it, and how far that shrinks.

The chapter begins with one page that is read in a minute; the tables follow.
"""

from collections.abc import Iterator
from typing import Literal

from bayesfric.plots.diagnosis import what_causes_it, where_it_lies
from bayesfric.plots.gap import how_far
from bayesfric.plots.style import to_svg
from bayesfric.report.chapters.diagnosis_details import axis_words, details
from bayesfric.report.content import (
    Block,
    Code,
    Figure,
    Heading,
    Inline,
    Notice,
    PageBreak,
    Reference,
    Strong,
)
from bayesfric.report.quantities import format_interval, format_probability, format_share
from bayesfric.report.stored import StoredDiagnosis
from bayesfric.schemas import Axis, Cause, DiagnosisFile, Gap, Interval

__all__ = ["diagnosis", "verdict_line"]

VERDICTS = {
    "no-gap": "No gap",
    "named": "Named",
    "unseparated": "Not told apart",
    "unknown": "Unknown",
}
KINDS: dict[str, Literal["attention", "good", "info"]] = {
    "no-gap": "good",
    "named": "info",
    "unseparated": "attention",
    "unknown": "attention",
}
FURTHER = 2  # axes after the first that the caption names


def verdict_line(found: DiagnosisFile) -> Notice:
    """Return the verdict for the report's first page."""
    return Notice(
        KINDS[found.verdict],
        [
            Strong(f"{VERDICTS[found.verdict]}."),
            f" {found.sentence} See ",
            Reference("diagnosis"),
            ".",
        ],
        title="Sim-to-real gap",
    )


def diagnosis(stored: StoredDiagnosis) -> Iterator[Block]:
    """Yield the page that tells all, then the tables."""
    found = stored.found
    yield PageBreak()
    yield Heading(1, "The gap between simulation and board", label="diagnosis")
    probability = format_probability(found.verdict_probability)
    yield Notice(
        KINDS[found.verdict],
        found.sentence,
        title=f"{VERDICTS[found.verdict]} (probability {probability})",
    )
    yield _where(stored)
    yield _which(stored)
    yield _how_far(stored)
    yield from details(found)


def _where(stored: StoredDiagnosis) -> Figure:
    axes = stored.found.where
    known = [axis for axis in axes if axis.share is not None]
    blind = [axis_words(axis.axis) for axis in axes if axis.blind]
    residuals = stored.group("residuals")
    shapes = any(axis.shape is not None for axis in axes)
    return Figure(
        to_svg(where_it_lies(axes, residuals)),
        [
            Strong("Where. "),
            *_largest(known),
            f"Did not vary, so that nothing is known: {', '.join(blind)}. " if blind else "",
            "Right: residual force, its systematic part with a simultaneous 95 % band; dots are "
            "windows of trials, far ones are cut."
            if shapes
            else "",
        ],
        "Left, a horizontal bar for each axis with the part of the squared gap that it explains"
        + (f", {axis_words(known[0].axis)} {format_share(known[0].share)} at most" if known else "")
        + (f"; {', '.join(blind)} did not vary" if blind else "")
        + ("; right, the residual force along the largest axes with a band." if shapes else "."),
        label="where",
        here=True,
    )


def _largest(known: list[Axis]) -> list[Inline]:
    """Return which axes explain most, in a sentence."""
    if not known:
        return ["No axis varied. "]
    first = known[0]
    rest = ", ".join(
        f"{axis_words(axis.axis)} {format_share(axis.share)}" for axis in known[1 : 1 + FURTHER]
    )
    return [
        f"{axis_words(first.axis).capitalize()} explains {format_share(first.share)} of gap² "
        f"(adjusted p {format_probability(first.p_value)})"
        + (f"; then {rest}. " if rest else ". "),
    ]


def _which(stored: StoredDiagnosis) -> Figure:
    found = stored.found
    best, probability = max(found.probabilities.items(), key=lambda item: item[1])
    amplitudes = stored.group("amplitudes") if found.causes else None
    drawn = amplitudes is not None
    return Figure(
        to_svg(what_causes_it(found, amplitudes)),
        [
            Strong("Which. "),
            "Most probable: ",
            Code(best),
            f" ({format_probability(probability)}). ",
            *(_cause(cause) for cause in found.causes),
            "Right: each cause's amplitude, densities scaled to their peaks, the 90 % interval "
            "above."
            if drawn
            else "",
            "" if found.causes else "No effect is named, so there is no amplitude.",
        ],
        f"Left, a horizontal bar for each hypothesis; the longest is {best} at "
        f"{format_probability(probability)}."
        + (" Right, posterior and prior of the amplitude of each cause." if drawn else ""),
        label="which",
        here=True,
    )


def _cause(cause: Cause) -> str:
    verdict = "is plausible" if cause.plausible else "is not plausible"
    return (
        f"The force of {cause.effect} is {format_share(cause.strength)} of friction (rms), and its "
        f"amplitude {verdict}. "
    )


def _how_far(stored: StoredDiagnosis) -> Figure:
    gap = stored.found.gap
    named = bool(stored.found.causes)
    trajectories = stored.group("trajectories")
    return Figure(
        to_svg(how_far(gap, trajectories, named)),
        [
            Strong("How far. "),
            *_tuning(gap),
            *_shrink(gap, named),
            "Bars are rms on conditions that the fit has not seen, lines their 90 % intervals."
            + (" Right: three held-out trials." if trajectories is not None else "")
            + (
                ""
                if gap.trajectory is not None
                else f" No figure in millimetres: {gap.trajectory_why}."
            ),
        ],
        "Left, horizontal bars: "
        + "; ".join(f"{name} {_newtons(number)}" for name, number in _arms(gap, named))
        + "."
        + (
            " Right, for each of three held-out trials, its path and how far simulation is from it"
            f" before{' and after the effect is added' if named else ''}."
            if trajectories is not None
            else ""
        ),
        label="how-far",
        here=True,
    )


def _tuning(gap: Gap) -> list[str]:
    """Return what recalibration alone does; never mixed with what the effect does."""
    if gap.as_shipped is None:
        return [f"As shipped: none ({gap.as_shipped_why}). "]
    return [f"Recalibration alone: {_newtons(gap.as_shipped)} to {_newtons(gap.before)}. "]


def _shrink(gap: Gap, named: bool) -> list[str]:
    if gap.shrink is None:
        return [f"Shrink by an effect: none ({gap.shrink_why}). "]
    if not named:
        return ["No effect is added. "]
    mean, low, high = (100 * one for one in (gap.shrink.mean, gap.shrink.q05, gap.shrink.q95))
    closed = format_interval(mean, low, high)
    return [f"Adding what is named closes {closed}\u202f% of what is between that and the floor. "]


def _arms(gap: Gap, named: bool) -> Iterator[tuple[str, Interval]]:
    if gap.as_shipped is not None:
        yield "as shipped", gap.as_shipped
    yield "recalibrated", gap.before
    if named:
        yield "with the effect", gap.after
    yield "floor", gap.floor


def _newtons(number: Interval) -> str:
    return format_interval(number.mean, number.q05, number.q95, "N")

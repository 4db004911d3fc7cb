"""Where the simulation misses the board, which effect causes it, and how far that shrinks.

The chapter begins with the verdict and a table that is read in ten seconds; the figures
that these rest on follow, each under its question. The long tables are in the details
of the HTML page.
"""

from collections.abc import Iterator
from functools import partial

from bayesfric.plots.diagnosis import RARE, axis_charts, how_far, what_acts, where_it_lies
from bayesfric.plots.labels import axis_words, sizes_of
from bayesfric.plots.style import svg_of
from bayesfric.probabilities import ALL_BUT, WIDE
from bayesfric.report.chapters.conditions import asked, condition_words, next_experiment
from bayesfric.report.chapters.diagnosis_details import (
    causes,
    not_told_apart,
    remainder,
    share_words,
)
from bayesfric.report.chapters.entering import replays
from bayesfric.report.chapters.gap_table import gap_table, gap_words
from bayesfric.report.chapters.joints import joints
from bayesfric.report.chapters.plain_law import own_law
from bayesfric.report.content import (
    Block,
    Code,
    Figure,
    Heading,
    Inline,
    Notice,
    Paragraph,
    Strong,
    Table,
    Text,
)
from bayesfric.report.diagnosed import VERDICTS, box, has_gap, listed
from bayesfric.report.quantities import (
    format_fixed,
    format_interval,
    format_number,
    format_probability,
    format_share,
)
from bayesfric.report.rig_words import group_words
from bayesfric.report.stored import StoredDiagnosis
from bayesfric.schemas import DiagnosisFile
from bayesfric.schemas.base import Interval
from bayesfric.schemas.gap import Axis, Gap

CHANCE = 0.05  # adjusted p above which an axis may explain by chance


def diagnosis(stored: StoredDiagnosis, *, alone: bool) -> Iterator[Block]:
    """Yield the verdict, how large the gap is, what causes it, where it lies, and what next.

    Alone, the chapter follows the verdict on page one, and does not repeat it.
    """
    record = stored.record
    yield Heading(1, "The gap between simulation and reality", label="diagnosis")
    if not alone:
        title = VERDICTS[record.verdict]
        if "probability" not in record.sentence:  # one number is told once
            title += f" (probability {format_probability(record.verdict_probability)})"
        yield Notice(box(record), record.sentence, title=title)
    if record.joints:
        yield from joints(record)
    yield _at_a_glance(record)
    yield from replays(stored)
    yield Heading(2, "How large it is")
    yield gap_words()
    yield gap_table(record)
    yield _how_far(stored)
    yield Heading(2, "Which effect")
    yield _which(record)
    yield from causes(record.causes)
    yield from not_told_apart(record)
    yield Heading(2, "Where it lies")
    if has_gap(record):
        if blind := _blind_axes(record):
            yield Paragraph(f"These axes did not vary, so nothing is known along them: {blind}.")
        yield _where(stored)
    else:
        yield Paragraph("There is no gap to locate.")
    yield from remainder(record)
    yield from asked(record.target)
    yield Heading(2, "What to measure next")
    yield from next_experiment(record)


def _at_a_glance(record: DiagnosisFile) -> Table:
    gap = record.gap
    friction = format_number(gap.friction_rms, unit=gap.unit)
    large = f"{_force(gap.systematic, gap.unit)} rms; friction is {friction} rms, and a gap "
    large += f"below {format_share(record.practical_share)} of that counts as none"
    if gap.no_share is not None:
        large = f"{_force(gap.systematic, gap.unit)}; as a share of friction it is unknown, "
        large += f"since {gap.no_share}"
    if gap.held_out_excess > gap.systematic.q95:
        unseen = format_number(gap.held_out_excess, 2, unit=gap.unit)
        large += f"; held-out data are off by {unseen} rms beyond scatter"
    rows: list[list[Text]] = [
        ["How large is the systematic gap?", large],
        ["Which effect causes it?", _caused(record)],
    ]
    if record.considered:
        rows.append(["What was considered, and is not named?", listed(record.considered)])
    if record.possible:
        also = " also" if record.causes else ""
        rows.append([f"What may{also} act?", listed(record.possible)])
    if record.present:
        rows.append(["What acts, but makes a negligible gap?", listed(record.present)])
    if gap.shrink_of_model is not None and record.causes:
        shrink = f"{_percent(gap.shrink_of_model)} of its mean square; {_seen(gap)}"
        rows.append(["How much of it do these causes remove?", shrink])
    if has_gap(record):
        rows.append(["Where does it lie?", _lies_along(record)])
    rows.append(
        [
            "How much of it is unexplained?",
            "nothing detectable in these data"
            if not record.remainder.significant
            else "more than chance explains"
            if record.causes
            else "all of it: no cause is named",
        ]
    )
    if record.next_experiment:
        first = record.next_experiment[0].condition
        rows.append(["What to measure next?", condition_words(first)])
    return Table("The diagnosis at a glance.", ["question", "answer"], rows, label="glance")


def _lies_along(record: DiagnosisFile) -> str:
    """Return along which axis it lies, or which come nearest to leading."""
    shared = [axis for axis in record.where if axis.share is not None]
    if record.all_unexplained_because or not shared:
        return f"open: {record.all_unexplained_because}"
    first = shared[0]
    chance = ""
    if (first.p_value or 0.0) > CHANCE:
        p = format_probability(first.p_value)
        chance = f"; not significant in held-out residuals alone (adjusted p {p})"
    if first.answers:
        return f"along {_with_share(first)}{chance}"
    nearest = " and ".join(_with_share(axis) for axis in shared[:2])
    return f"no single axis dominates; the largest shares: {nearest}"


def _blind_axes(record: DiagnosisFile) -> str:
    """Return the axes that did not vary, in words."""
    return ", ".join(axis_words(axis.axis) for axis in record.where if axis.blind)


def _with_share(axis: Axis) -> str:
    """Write the name of an axis with its share."""
    return f"{axis_words(axis.axis)} (share {share_words(axis.share)})"


def _caused(record: DiagnosisFile) -> list[Inline]:
    if record.causes:
        said: list[Inline] = []
        if record.verdict == "undecided":
            said.append("undecided, since the gap may be negligible: ")
        for place, cause in enumerate(record.causes):
            said += [
                ", " if place else "",
                Code(cause.effect),
                f" (probability {format_probability(cause.inclusion_probability)})",
            ]
        return said
    uncaused = {
        "no-gap": "none is needed",
        "unknown": "a force that no effect of the list explains",
        "unseparated": "one of several that these data do not tell apart",
    }
    return [uncaused.get(record.verdict, "open: none is probable enough to be named")]


def _where(stored: StoredDiagnosis) -> Figure:
    record = stored.record
    axes = record.where
    shared = [axis for axis in axes if axis.share is not None]
    blind = _blind_axes(record)
    residuals = stored.group("residuals")
    shapes = any(axis.shape is not None for axis in axes)
    first = f", {_with_share(shared[0])} first" if shared else ""
    sizes = sizes_of(record.law)
    return Figure(
        svg_of(where_it_lies, axes, residuals, record.gap.unit, sizes, record.unexplained),
        [
            Strong("Where."),
            " Left: the share of each axis in the variance of the systematic force, with its 90 % "
            "interval; with that of no axis the shares add up to 1. A dark bar dominates; a "
            "diamond is what the axis explains alone.",
            " Right: residual force on held-out data, its systematic part with a "
            "simultaneous 95 % band; dots are windows of trials, and distant ones are cut off."
            if shapes
            else "",
        ],
        f"Left, a horizontal bar for the share of each axis{first}"
        + ("; right, the residual force along the largest axes with a band" if shapes else "")
        + (f"; {blind} did not vary." if blind else "."),
        label="where",
        floats=True,
        charts=partial(axis_charts, axes, residuals, record.gap.unit) if shapes else None,
        beside=True,
    )


def _which(record: DiagnosisFile) -> Figure | Paragraph:
    included = record.inclusion
    best, probability = max(record.probabilities.items(), key=lambda item: item[1])
    most: list[Inline] = [
        "Most probable: ",
        Code(best),
        f" ({format_probability(probability)}). ",
    ]
    hypotheses: list[Inline] = ["All hypotheses: ", Code("diagnosis.json"), "."]
    if not any(effect.probability > RARE for effect in included):
        none = f"No effect has a posterior probability above {format_probability(RARE)}. "
        return Paragraph([Strong("Hypotheses."), " ", *most, none, *hypotheses])
    return Figure(
        svg_of(what_acts, included, record.practical_share),
        [
            Strong("Hypotheses."),
            " ",
            *most,
            "Left: posterior probability that an effect acts, summed over all hypotheses; dotted "
            "at 0.1 and 0.9. Right: its strength if it acts, with its 90 % interval; dashed: "
            f"{format_share(record.practical_share)} of friction, below which a gap counts as "
            "none. ",
            *hypotheses,
        ],
        "Left, a horizontal bar for each effect; the longest is "
        f"{included[0].effect} at {format_probability(included[0].probability)}; right, how strong "
        "each is.",
        label="which",
        floats=True,
    )


def _how_far(stored: StoredDiagnosis) -> Figure:
    record = stored.record
    gap = record.gap
    named = bool(record.causes)
    trajectories = stored.group("trajectories")
    return Figure(
        svg_of(how_far, gap, record.practical_share, trajectories, named),
        [
            Strong("How large."),
            " ",
            *_tuning(gap),
            *_shrink(gap, named, group_words(record.rigs)[1]),
            "Bars: rms error on conditions that the fit has not seen, and the posterior of the "
            "systematic gap. Lines: 90 % intervals. Dashed: "
            f"{format_share(record.practical_share)} of friction, below which a gap counts as "
            "none."
            + (" Right: three held-out trials." if trajectories is not None else "")
            + (
                ""
                if gap.trajectory is not None or own_law(record.rigs)
                else f" No number in millimetres: {gap.trajectory_why}."
            ),
        ],
        "Left, horizontal bars: "
        + "; ".join(f"{name} {_force(number, gap.unit)}" for name, number in _arms(gap, named))
        + "."
        + (
            " Right, for each of three held-out trials, its path and how far simulation is from it"
            f" before{' and after the effect is added' if named else ''}."
            if trajectories is not None
            else ""
        ),
        label="how-far",
        floats=True,
    )


def _tuning(gap: Gap) -> list[str]:
    """Return what recalibration alone does; never mixed with what the effect does."""
    if gap.as_shipped is None:
        return [f"No error as shipped: {gap.as_shipped_why}. "]
    shipped, before = _force(gap.as_shipped, gap.unit), _force(gap.before, gap.unit)
    return [f"Recalibration alone changes the held-out error from {shipped} to {before}. "]


def _shrink(gap: Gap, named: bool, groups: str) -> list[str]:
    if not named:
        return ["No effect is added. "]
    if gap.shrink_of_model is None:
        return [f"The causes remove nothing: {gap.shrink_of_model_why}. "]
    taken = _percent(gap.shrink_of_model)
    said = [f"Adding the named causes removes {taken} of the systematic gap (mean square)"]
    if gap.shrink is not None:
        said.append(f", and {_percent(gap.shrink)} of the error of held-out {groups} above scatter")
    else:
        said.append(f"; held-out {groups} cannot confirm that: {gap.shrink_why}")
    return [*said, ". "]


def _seen(gap: Gap) -> str:
    """Return what data held out say of a shrink; that they cannot tell is said too."""
    if gap.shrink is None:
        return "held-out data cannot confirm that"
    return f"{_percent(gap.shrink)} on held-out data, above scatter"


def _arms(gap: Gap, named: bool) -> Iterator[tuple[str, Interval]]:
    if gap.as_shipped is not None:
        yield "as shipped", gap.as_shipped
    yield "recalibrated", gap.before
    if named:
        yield "with the effect", gap.after
    yield "floor", gap.floor
    yield "systematic", gap.systematic


def _percent(number: Interval) -> str:
    """Write a share as the verdict's own sentence does, a wide one to whole per cent."""
    decimals = 0 if number.q95 - number.q05 >= WIDE else 1
    middle, low, high = (
        format_fixed(100 * quantile, decimals) for quantile in (number.q50, number.q05, number.q95)
    )
    if number.q05 >= ALL_BUT and number.q95 <= 1:
        return f"more than {100 * ALL_BUT:.1f}\u202f%"
    return f"{middle} [{low}, {high}]\u202f%"


def _force(number: Interval, unit: str) -> str:
    return format_interval(number.q50, number.q05, number.q95, unit)

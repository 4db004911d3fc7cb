"""The verdict in the box on page one: how things are today, what was found, and what to do."""

from collections.abc import Iterator

from bayesfric.attention.diagnosis import biased_numbers, why_untrusted
from bayesfric.diagnosis.held_out_sentence import held_out_words
from bayesfric.diagnosis_rules import RULES
from bayesfric.plots.labels import axis_words
from bayesfric.report.chapters.conditions import condition_words
from bayesfric.report.content import Inline, Notice, Reference, Strong
from bayesfric.report.diagnosed import VERDICTS, box, has_gap, listed
from bayesfric.report.quantities import format_number, format_share
from bayesfric.schemas import DiagnosisFile

ALONG_THE_WAY = ("displacement", "travel")


def verdict_line(record: DiagnosisFile) -> Notice:
    """Return the verdict for the report's first page; a simulator that is off today comes first.

    Parameters
    ----------
    record : DiagnosisFile
        As it is stored.
    """
    open_still = record.verdict == "undecided" and record.possible
    off = _off_today(record)
    verdict = Strong(f"{_headline(record)}.")
    begun: list[Inline] = [verdict, " "]
    said = _with_meanings(record)
    if off and _nothing_left(record):
        begun = [Strong(f"{off} The numbers below correct this:"), " "]
        said = said[:1].lower() + said[1:]
    elif off:
        begun = [Strong(off), " ", *begun]
    return Notice(
        "attention" if off or _is_biased(record) else box(record),
        [
            *begun,
            f"{said} ",
            f"What may act: {listed(record.possible)}. " if open_still else "",
            *_measure_next(record),
            "See ",
            Reference("diagnosis"),
            ".",
        ],
        title="Sim-to-real gap",
        points=list(_of_joints(record)),
    )


def _headline(record: DiagnosisFile) -> str:
    """Return the verdict in a few words, with what a reader must not miss."""
    said = VERDICTS[record.verdict]
    if record.joints:
        return said
    if _is_biased(record):
        return f"{said}, but the coefficients of the law alone are biased"
    is_certain = record.gap.probability_above_practical >= RULES.sure
    if record.verdict == "undecided" and is_certain and not record.causes:
        return "There is a gap; its cause is undecided"
    return said


def _is_biased(record: DiagnosisFile) -> bool:
    """Tell whether the law alone leaves no gap because its coefficients absorb a force."""
    return record.verdict == "no-gap" and not record.joints and bool(biased_numbers(record))


def _measure_next(record: DiagnosisFile) -> Iterator[str]:
    """Yield what to measure where the cause, or the gap itself, stays open."""
    gap, share = record.gap, record.practical_share
    if record.verdict in ("no-gap", "named"):
        return
    if record.next_experiment:
        proposed = record.next_experiment[0]
        rivals = " and ".join(proposed.separates)
        yield f"Measure next: {condition_words(proposed.condition)}, which separates {rivals}. "
        return
    if record.verdict == "unknown":
        yield from _look_for_it(record)
        return
    low, high = (end / gap.friction_rms for end in (gap.systematic.q05, gap.systematic.q95))
    if record.verdict == "undecided" and gap.no_share is None and low < share < high:
        yield (
            "Measure next: more assemblies at the same conditions, to narrow the gap's interval. "
        )


def _look_for_it(record: DiagnosisFile) -> Iterator[str]:
    """Yield what to do about a force without a cause: where it holds, and what to measure."""
    yield "Until the cause is known, use the numbers below only at the conditions measured. "
    leading = next((axis.axis for axis in record.where if axis.answers), None)
    if leading in ALONG_THE_WAY:
        yield (
            "Look along the travel for what the force belongs to: a splice or kink of the cable, a "
            "worn pulley, a magnet. Measure next: the same condition with the cable moved on by a "
            "known length; what belongs to the cable moves with it. "
        )
    elif leading is not None:
        yield (
            f"Measure next: one condition again, with {axis_words(leading)} alone changed over its "
            "whole range. "
        )
    else:
        yield "Measure next: further conditions, each of which changes one thing alone. "


def _off_today(record: DiagnosisFile) -> str:
    """Return how far the simulator is off with its own numbers; empty where that counts as none."""
    said = []
    for joint in record.joints or (record,):
        gap, now = joint.gap, joint.gap.as_shipped
        if not joint.enter or now is None or now.q50 < joint.practical_share * gap.friction_rms:
            continue
        share = (
            ""
            if gap.no_share is not None
            else f" ({format_share(now.q50 / gap.friction_rms)} of friction)"
        )
        at = "" if joint.joint is None else f" at {joint.joint}"
        said.append(f"{format_number(now.q50, 2, unit=gap.unit)} rms{share}{at}")
    if not said:
        return ""
    return f"Your simulator, as it is, is off by {' and '.join(said)}."


def _nothing_left(record: DiagnosisFile) -> bool:
    """Tell whether the numbers to enter leave no gap at any joint, as held-out data confirm."""
    return not any(
        has_gap(joint) or why_untrusted(joint) is not None for joint in record.joints or (record,)
    )


def is_sound(record: DiagnosisFile) -> bool:
    """Tell whether held-out data confirm the numbers to enter of every joint."""
    return all(
        bool(joint.enter and joint.gap.held_out)
        and joint.verdict in ("no-gap", "named")
        and joint.gap.held_out_excess == 0
        and why_untrusted(joint) is None
        for joint in record.joints or (record,)
    )


def _of_joints(record: DiagnosisFile) -> Iterator[list[Inline]]:
    """Yield the verdict of each joint, with its own sentence; nothing for a single one."""
    for joint in record.joints:
        verdict = VERDICTS[joint.verdict]
        yield [Strong(f"{joint.joint}: {verdict[:1].lower()}{verdict[1:]}."), f" {joint.sentence}"]


def _with_meanings(record: DiagnosisFile) -> str:
    """Return the verdict's sentence, in which each cause is followed by what it is."""
    said = record.sentence
    if record.joints:  # each has its own sentence below
        said = said.partition(f" At {record.joint}: ")[0]
    if not record.joints and why_untrusted(record) is not None:  # told at the numbers, below
        effects = record.causes or record.considered
        said = said.removesuffix(f" {held_out_words(record.gap, effects, record.verdict)}")
    for cause in record.causes:
        said = said.replace(cause.effect, f"{cause.effect} ({cause.sentence})", 1)
    return said[:1].upper() + said[1:]

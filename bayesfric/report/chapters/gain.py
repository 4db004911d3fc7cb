"""Controller margins on page one: whether a loop meets its spec, and which gain to set."""

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Literal

from bayesfric.margins.terms import (
    at_safe_gain_words,
    chance_of_missing,
    in_degrees_or_decibels,
    safe_up_to,
    safety_words,
)
from bayesfric.plots.margins import (
    error_and_headroom,
    has_error_or_headroom,
    hunting_curve,
    limit_cycle_against_gain,
)
from bayesfric.plots.style import svg_of
from bayesfric.report.chapters.specs import (
    SHOWN_UNITS,
    at_gain,
    called,
    is_borderline,
    missing_metrics,
    spaced,
    spec_table,
    words_of,
)
from bayesfric.report.content import (
    Block,
    Code,
    Figure,
    Notice,
    Paragraph,
    Reference,
    from_file,
)
from bayesfric.report.quantities import format_interval, format_number, format_share
from bayesfric.report.words import sentences
from bayesfric.schemas import MarginsFile
from bayesfric.schemas.margins import LoopMargins

NOW = ", as in the file, it hunts in "  # stands in what an answer says of the γ of the file
HUNTING = (
    "A loop hunts if it oscillates about its target in a limit cycle instead of settling; γ is the "
    "share of the modelled friction that the controller compensates."
)
UNIT = re.compile(r"(_(n|m|mm|s|a|hz|kg|rad|deg|per|m2|s2))+$")
ASSUMED = "Assumed: "  # begins a remark of a loop's file on what nobody measured
LITTLE, MOST = 0.01, 0.5  # of a variance
THIN_BAND = 0.02  # of a probability, below which a band hides behind its line
LAW = "c1, c2, c3"  # the group of a variance that the friction law is


def gain_lines(margins: MarginsFile, *, alone: bool) -> Iterator[Block]:
    """Yield, for page one, whether each loop is safe, and up to which compensation gain.

    Parameters
    ----------
    margins : MarginsFile
        What ``bayesfric margins`` wrote.
    alone : bool
        Whether nothing else is on that page, which then has the specs.
    """
    if alone:
        yield Paragraph([f"{HUNTING} For what was not examined, see ", Reference("margins"), "."])
    for loop in margins.loops:
        beside = _named(loop) if alone else _missed(loop)
        said = " ".join(filter(None, [*_gain(loop), *beside]))
        yield Notice(_kind(loop), said, title=_title(loop))
    if not alone:
        return
    yield from spec_table(margins, " ".join(line for loop in margins.loops for line in _gain(loop)))
    yield from _deciding_numbers(margins.loops)
    if law := _of_law(margins):
        yield Paragraph(law)
    yield from _assumed(margins.loops)


def _deciding_numbers(loops: Sequence[LoopMargins]) -> Iterator[Block]:
    """Yield how much the friction law decides; a warning if an assumed number decides most."""
    for loop in loops:
        said = " ".join(_decided(loop))
        of = f"{loop.name}: " if len(loops) > 1 else ""
        if _deciding(loop) is not None:
            title = f"{of}{'an' if of else 'An'} assumed number makes most of friction's variance"
            yield Notice("attention", said, title=title)
        elif said:
            yield Paragraph([Code(loop.name), f": {said}"] if of else said)


def _of_law(margins: MarginsFile) -> str:
    """Return of which law the margins are; empty where it is the fitted one, and no other is due.

    The section has its sentence in any case.
    """
    law = margins.law
    if law is None or (law.used == "fitted" and law.warning is None):
        return ""
    if law.used == "refitted" and law.causes:
        return f"Margins of the law refitted with {' and '.join(law.causes)}."
    return law.sentence


def _assumed(loops: Sequence[LoopMargins]) -> Iterator[Notice]:
    """Yield what the files of the loops assume, which the answer rests on."""
    for loop in loops:
        assumed = [
            _ended(warning.removeprefix(ASSUMED))
            for warning in loop.warnings
            if warning.startswith(ASSUMED)
        ]
        if assumed:
            of = "" if len(loops) == 1 else f"{loop.name}: "
            yield Notice(
                "info", " ".join(assumed), title=f"{of}{'a' if of else 'A'}ssumed, not measured"
            )


def _ended(text: str) -> str:
    return text.removesuffix(".") + "."


def _title(loop: LoopMargins) -> str:
    words = safety_words(loop)
    deciding = _deciding(loop)
    if deciding is None or _kind(loop) == "attention":
        return f"{loop.name}: {words}"
    return f"{loop.name}: {words}, if the assumed {key_words(deciding)} is right"


def _named(loop: LoopMargins) -> Iterator[str]:
    """Yield which specs the loop misses, hunting aside, at the γ of its file."""
    others = [
        called(metric) + (" (borderline)" if is_borderline(loop, metric) else "")
        for metric in missing_metrics(loop)
        if metric.name != "gamma_hunting"
    ]
    if others:
        yield f"Specs not met{at_gain(loop)}: {', '.join(others)}."
    yield at_safe_gain_words(loop, words_of)


def _missed(loop: LoopMargins) -> Iterator[str]:
    """Yield each metric that misses its spec: its 90 % interval, the spec, and how probably."""
    said = []
    for stored in missing_metrics(loop):
        metric = in_degrees_or_decibels(stored) or stored
        interval = metric.interval
        if interval is None or metric.spec is None or metric.name == "gamma_hunting":
            continue
        unit, scale = SHOWN_UNITS.get(metric.unit, (metric.unit, 1.0))
        words = called(metric)
        measured = format_interval(
            scale * interval.q50, scale * interval.q05, scale * interval.q95, unit
        )
        asked = spaced(f"{metric.sense} {scale * metric.spec:.3g}", unit)
        chance = chance_of_missing(metric)
        missed = "" if chance is None else f", missed with probability {chance}"
        said.append(f"{words} {measured} ({asked} is asked for{missed})")
    if said:
        yield f"Misses its spec: {'; '.join(said)}."


def _gain(loop: LoopMargins) -> Iterator[str]:
    """Yield whether the loop hunts at the gain of its file, and up to which gain it is safe."""
    gamma, most = loop.largest_safe_compensation_gain, loop.limit_cycle_probability_max
    for said in sentences(loop.answer):
        if NOW in said:
            hunting = said.partition(NOW)[2].removesuffix(".")
            yield f"It hunts in {hunting.partition(' (at 95')[0].partition(', ')[0]}."
    if loop.compensation_signal == "none":
        yield "It has no friction compensation whose gain could be set."
    elif gamma is None:
        yield f"No gain γ is safe: {loop.largest_safe_compensation_gain_why}."
    else:
        share = f"{100 * most:g}\u202f%"
        yield f"Up to γ = {safe_up_to(loop)} it hunts in at most {share} of the draws."


def _decided(loop: LoopMargins) -> Iterator[str]:
    """Yield how much of the variance of friction c1 to c3 decide, and what decides most."""
    shares = _shares_of_friction(loop)
    if LAW not in shares:
        return
    first = max(shares, key=lambda name: shares[name])
    law = "under 1 %" if shares[LAW] < LITTLE else format_share(shares[LAW])
    yield f"c1, c2 and c3 contribute {law} of the variance of friction."
    if "." in first:  # a number of the loop's file
        words = key_words(first)
        said = words if words == first else f"{words} ({first})"
        yield f"The assumed {said} contributes {format_share(shares[first])}: measure it."


def _shares_of_friction(loop: LoopMargins) -> Mapping[str, float]:
    """Return which share of the variance of friction each group of numbers makes."""
    return loop.variance_share.get("gamma_necessary") or loop.variance_share.get(
        "steady_error_servo", {}
    )


def _deciding(loop: LoopMargins) -> str | None:
    """Return the number of the loop's file that makes most of the variance of friction."""
    of_file = [key for key, share in _shares_of_friction(loop).items() if share > MOST]
    return next((key for key in of_file if "." in key), None)


def key_words(key: str) -> str:
    """Return a key of the loop file in words: ``joint.inertia_kg_m2`` as joint inertia."""
    words = UNIT.sub("", key).replace("_", " ").split(".")
    if words[0] == "runs":
        words = [words[2], "of run", str(int(words[1]) + 1)]
    return " ".join(words)


def gain_figures(margins: MarginsFile) -> Iterator[Block]:
    """Yield the figures of all loops together."""
    yield from _hunting(margins.loops)
    if has_error_or_headroom(margins.loops):
        yield Figure(
            svg_of(error_and_headroom, margins.loops),
            from_file(
                "margins.json",
                "Errors at the tool tip, and remaining torque as a share of its limit: median and "
                "5 % to 95 % of the draws. Black tick: the spec.",
            ),
            "Horizontal bars with a dot at the median, in groups by loop: errors in millimetres "
            "on the left, torque headroom in per cent on the right.",
            label="error-headroom",
        )


def _kind(loop: LoopMargins) -> Literal["attention", "good", "info"]:
    hunts = [metric for metric in loop.metrics if metric.name == "gamma_hunting"]
    p = hunts[0].probability_of_violation if hunts else None
    missed = [loop.missed_specs]
    if loop.with_effects is not None:
        missed.append(loop.with_effects.missed_specs)
    if any(names is None or names for names in missed):
        return "attention"
    if p is None and loop.largest_safe_compensation_gain is None:
        return "attention"
    # Green would cover what the loop's remarks say of its assumptions.
    return "info" if loop.warnings or loop.not_examined else "good"


def _hunting(loops: Sequence[LoopMargins]) -> Iterator[Block]:
    curves = [loop for loop in loops if loop.limit_cycle_probability]
    if not curves:
        return
    yield Figure(
        svg_of(limit_cycle_against_gain, curves),
        from_file(
            "margins.json",
            "Probability that the loop hunts, over the compensation gain. "
            f"{_band(curves)} Dot: the γ of the loop's file. Dotted: the probability that the file "
            f"allows. Vertical line: the largest γ that is safe from hunting{_elsewhere(curves)}.",
        ),
        "A line for each loop over the compensation gain, which rises where the loop begins to "
        "hunt.",
        label="limit-cycle",
    )


def _elsewhere(loops: Sequence[LoopMargins]) -> str:
    """Return at which γ alone the other specs were judged, where it is not the safe one."""
    at_both = any(loop.at_safe_gain is not None for loop in loops)
    return "" if at_both else "; other specs are judged at the file's γ"


def _band(loops: Sequence[LoopMargins]) -> str:
    """Return what is shaded: the Monte Carlo error, where a reader can see it."""
    error = 2 * max(float(hunting_curve(loop)[2].max()) for loop in loops)
    if error < THIN_BAND:
        return (
            f"Twice its Monte Carlo error, at most {format_number(error, 1)}, is too thin to see."
        )
    return "Shaded: twice its Monte Carlo error."

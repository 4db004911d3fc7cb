"""Controller margins on page one: whether a loop meets its spec, and which gain to set."""

from collections.abc import Iterator, Sequence
from typing import Literal

import numpy as np

from bayesfric.plots.margins import (
    error_and_headroom,
    has_error_or_headroom,
    limit_cycle_against_gain,
)
from bayesfric.plots.style import svg_of
from bayesfric.report.content import Block, Figure, Notice, Reference, from_file
from bayesfric.report.quantities import format_interval, format_number, format_share
from bayesfric.schemas import LoopMargins, MarginsFile

SHOWN_UNITS = {
    "m": ("mm", 1e3),
    "s": ("ms", 1e3),
    "1": ("", 1.0),
    "rad": ("rad", 1.0),
    "deg": ("°", 1.0),
}
WORDS = {
    "friction_nominal": "friction, eq. (15)",
    "friction_recursive": "friction, pulley by pulley",
    "steady_error_servo": "steady error of the servo",
    "lost_motion": "lost motion of the cable",
    "headroom_clip": "headroom to the clip",
    "headroom_continuous": "headroom to continuous torque",
    "gamma_necessary": "γ necessary to hunt",
    "gamma_hunting": "γ that hunts",
    "amplitude_margin": "amplitude margin",
    "limit_cycle_amplitude": "amplitude of the limit cycle",
    "limit_cycle_frequency": "frequency of the limit cycle",
    "gain_margin": "gain margin",
    "phase_margin": "phase margin",
    "disk_margin": "disk margin",
    "delay_margin": "delay margin",
    "backdrive_force": "backdrive force",
    "smallest_step": "smallest step",
    "reversal_error": "reversal error",
    "cable_stretch": "stretch of the cable",
    "least_tension": "least tension of a side",
    "peak_tension": "peak tension of a side",
    "sensitivity_peak": "peak of the sensitivity, Ms",
    "complementary_peak": "peak of the complementary sensitivity, Mt",
}


def gain_lines(margins: MarginsFile, *, alone: bool) -> Iterator[Block]:
    """Yield, for page one, the largest safe compensation gain of each loop.

    Parameters
    ----------
    margins : MarginsFile
        What ``bayesfric margins`` wrote.
    alone : bool
        Whether nothing else is on that page, which then has the figures.
    """
    for loop in margins.loops:
        yield Notice(
            _kind(loop),
            [
                *_missed(loop),
                _gain(loop),
                " What decides, and what was not examined: ",
                Reference("margins"),
                ".",
            ],
            title=f"{loop.name}: {_verdict(loop)}",
        )
    if alone:
        yield from gain_figures(margins)


def _verdict(loop: LoopMargins) -> str:
    """Return whether a loop meets its spec, in a few words."""
    if not loop.missed_specs:
        return "meets its spec"
    names = [name.partition(" ")[0] for name in loop.missed_specs]
    return (
        f"misses its spec in {', '.join(WORDS.get(name, name.replace('_', ' ')) for name in names)}"
    )


def _missed(loop: LoopMargins) -> Iterator[str]:
    """Yield each metric that misses its spec, with its 90 % interval and the spec."""
    for metric in loop.metrics:
        name = " ".join(filter(None, (metric.name, metric.direction)))
        if name not in (loop.missed_specs or ()) or metric.interval is None or metric.spec is None:
            continue
        unit, scale = SHOWN_UNITS.get(metric.unit, (metric.unit, 1.0))
        words = WORDS.get(metric.name, metric.name)
        if metric.direction is not None:
            words += f", {metric.direction}"
        interval = metric.interval
        measured = format_interval(
            scale * interval.q50, scale * interval.q05, scale * interval.q95, unit
        )
        asked = f"{metric.sense} {scale * metric.spec:g}\N{NARROW NO-BREAK SPACE}{unit}".rstrip()
        yield f"{words[:1].upper()}{words[1:]}: {measured}, {asked} is asked for. "


def _gain(loop: LoopMargins) -> str:
    """Return which compensation gain to set, in a sentence."""
    gamma, most = loop.largest_safe_compensation_gain, loop.limit_cycle_probability_max
    allowed = f"a probability of {format_share(most)} or less"
    if loop.compensation_signal == "none":
        return "It has no friction compensation whose gain could be set."
    if gamma is None:
        return f"No gain γ is safe: {loop.largest_safe_compensation_gain_why}."
    now = f"the file has {format_number(loop.compensation_gain, 3)}"
    down = np.floor(100 * gamma) / 100
    if gamma >= loop.limit_cycle_probability[-1].gamma:
        return f"Up to γ = {down:g} it hunts with {allowed}; {now}."
    return f"Set γ to {down:.2f} at most ({now}): up to there it hunts with {allowed}."


def gain_figures(margins: MarginsFile) -> Iterator[Block]:
    """Yield the figures of all loops together."""
    yield from _hunting(margins.loops)
    if has_error_or_headroom(margins.loops):
        yield Figure(
            svg_of(error_and_headroom, margins.loops),
            from_file(
                "margins.json",
                "Errors at the tool tip, and torque left as a share of its limit: median and 5 % "
                "to 95 %; the black tick is the spec.",
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
            "Probability that the loop hunts, over the compensation gain, with twice its Monte "
            "Carlo error. The marker is the γ of the loop's file, the dotted line the spec, the "
            "upright line the largest γ within it.",
        ),
        "A rising line from zero to one for each loop over the compensation gain from zero to "
        "three.",
        label="limit-cycle",
    )

"""The specs of a loop on page one: how probably each is missed, at the file's γ and a safe one."""

import re
from collections.abc import Iterator, Sequence

from bayesfric.margins.margin_rules import MARGIN_RULES
from bayesfric.margins.metric_definitions import LINEAR, full_name
from bayesfric.margins.terms import (
    chance_of_missing,
    in_degrees_or_decibels,
    is_missed,
    safe_up_to,
)
from bayesfric.report.content import Strong, Table, Text, right_columns
from bayesfric.report.quantities import MISSING, error_cells, format_count, format_number
from bayesfric.schemas import MarginsFile
from bayesfric.schemas.margins import LoopMargins, Metric

TWICE = 2.0  # Monte Carlo errors: nearer to what is allowed, a probability is borderline
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
    "headroom_clip": "headroom to the torque limit",
    "headroom_continuous": "headroom to continuous torque",
    "gamma_necessary": "γ necessary to hunt at rest",
    "gamma_hunting": "γ from which it hunts",
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
    "least_tension": "least cable tension",
    "peak_tension": "peak cable tension",
    "sensitivity_peak": "peak of the sensitivity, Ms",
    "complementary_peak": "peak of the complementary sensitivity, Mt",
}


def at_gain(loop: LoopMargins) -> str:
    """Return at which γ the specs were judged, that of the file; nothing without compensation."""
    none = loop.compensation_signal == "none"
    return "" if none else f" at γ = {loop.compensation_gain:.3g}"


def called(metric: Metric) -> str:
    """Return a metric in words, with the direction of motion where it has one."""
    return words_of(metric.name, metric.direction or "")


def words_of(name: str, direction: str) -> str:
    """Return the name of a metric in words, with a direction of motion behind it, if any."""
    return ", ".join(filter(None, (WORDS.get(name, name.replace("_", " ")), direction)))


def missing_metrics(loop: LoopMargins) -> Iterator[Metric]:
    """Return the metrics that miss their specs more often than the file allows."""
    return (metric for metric in loop.metrics if is_missed(loop, metric))


def _at_all(loops: Sequence[LoopMargins]) -> str:
    """Return at which γ all specs were judged; those of the files where these differ."""
    places = {at_gain(loop) for loop in loops}
    return places.pop() if len(places) == 1 else " at the γ of each file"


def spec_table(margins: MarginsFile, said: str) -> Iterator[Table]:
    """Yield the figures that have a spec, those that miss it in bold; none where there is none.

    Parameters
    ----------
    margins : MarginsFile
        As it is stored.
    said : str
        What page one says of hunting, from which the count of simulated draws is taken.
    """
    loops = margins.loops
    lower = any(loop.at_safe_gain is not None for loop in loops)
    rows = [
        [*([] if len(loops) == 1 else [loop.name]), *row]
        for loop in loops
        for row in _judged(loop, lower=lower)
    ]
    if not rows:
        return
    at_file, at_safe = "P(missed)", "at the safe γ"
    if lower and len(loops) == 1:
        at_file, at_safe = f"missed{at_gain(loops[0])}", f"at γ = {safe_up_to(loops[0])}"
    yield Table(
        f"Specs of the loop's file, and the probability that each is missed{_at_all(loops)}"
        f"{' and at the safe γ' * lower}.",
        [
            *([] if len(loops) == 1 else ["loop"]),
            "metric",
            *right_columns(
                at_file,
                *([at_safe] if lower else []),
                "allowed",
                "spec",
                "5 % to 95 % of the draws",
            ),
        ],
        rows,
        label="specs",
        note=f"{_bold(loops)}“γ from which it hunts” must be at least the γ that is set"
        f"{', which differs between the two columns' * lower}; its own value does not "
        f"depend on that γ.{_of_the_file(loops) if lower else ''}"
        f"{_simulated(margins, said)}{_below_simulated(margins)}{_without_friction(loops)}",
    )


def _bold(loops: Sequence[LoopMargins]) -> str:
    """Return what bold says, where something is."""
    missed = any(next(missing_metrics(loop), None) is not None for loop in loops)
    bold = "Bold: missed more often than the file allows. " if missed else ""
    judged = [(loop, metric) for loop in loops for metric in loop.metrics]
    if any(is_borderline(loop, metric) for loop, metric in judged):
        bold += "With an error (±): within two Monte Carlo errors of what is allowed. "
    return bold


def _of_the_file(loops: Sequence[LoopMargins]) -> str:
    """Return of which γ the last column is, where there are two."""
    return f" 5 % to 95 % of the draws:{_at_all(loops)}."


def _simulated(margins: MarginsFile, said: str) -> str:
    """Return in how many draws hunting is looked for, where these are not all."""
    counts = {int(count) for count in re.findall(r" of (\d+) draws", said)} - {margins.draws}
    if not counts:
        return ""
    return (
        f" Hunting is simulated in {' or '.join(map(str, sorted(counts)))} draws; all other "
        f"metrics use {format_count(margins.draws)} draws."
    )


def _below_simulated(margins: MarginsFile) -> str:
    """Return by how much the largest safe γ lies below the simulated one; empty without any."""
    simulated = any(
        metric.note.startswith("simulated")
        for loop in margins.loops
        if loop.largest_safe_compensation_gain is not None
        for metric in loop.metrics
        if metric.name == "gamma_hunting"
    )
    if not simulated:
        return ""
    rules = MARGIN_RULES
    return (
        f" A simulated γ may be off by {rules.threshold_tolerance:g} or "
        f"{100 * rules.threshold_share:g}\u202f%, whichever is more; the largest safe γ "
        "already includes this error."
    )


def _without_friction(loops: Sequence[LoopMargins]) -> str:
    """Return that linear margins do not show hunting; empty where none of them has a spec."""
    if not any(
        metric.spec is not None and metric.name in LINEAR
        for loop in loops
        for metric in loop.metrics
    ):
        return ""
    return " Gain, phase, disk and delay margins leave friction out: they do not show hunting."


def _judged(loop: LoopMargins, *, lower: bool) -> Iterator[list[Text]]:
    """Yield a row for each figure with a spec: how probably it is missed, spec and interval.

    With `lower`, a row also has how probably the spec is missed at the safe γ.
    """
    missing = tuple(missing_metrics(loop))
    for stored in loop.metrics:
        metric = in_degrees_or_decibels(stored) or stored
        if metric.spec is None or metric.interval is None:
            continue
        unit, scale = SHOWN_UNITS.get(metric.unit, (metric.unit, 1.0))
        low, high = (
            format_number(scale * q, 2) for q in (metric.interval.q05, metric.interval.q95)
        )
        asked = f"{metric.sense} {scale * metric.spec:.3g}"
        if lower and metric.name == "gamma_hunting":
            asked = f"{metric.sense} the γ set"
        row = [
            called(metric),
            _chance(loop, metric),
            _allowed(loop, metric),
            spaced(asked, unit),
            spaced(f"{low} to {high}", unit),
        ]
        cells: list[Text] = [Strong(cell) if stored in missing else cell for cell in row]
        yield [*cells[:2], *([_at_safe(loop, stored)] if lower else []), *cells[2:]]


def _at_safe(loop: LoopMargins, metric: Metric) -> Text:
    """Return how probably a spec is missed at the safe γ; a dash where the file's γ is safe."""
    there = loop.at_safe_gain
    if there is None:
        return MISSING
    if metric.name == "gamma_hunting":
        return f"≤ {loop.limit_cycle_probability_max:g}"
    named = (metric.name, metric.direction)
    (lower,) = (row for row in there.metrics if (row.name, row.direction) == named)
    chance = _chance(loop, lower)
    return Strong(chance) if full_name(metric) in there.missed_specs else chance


def _chance(loop: LoopMargins, metric: Metric) -> str:
    """Return how probably a spec is missed, with its error where that decides."""
    p, error = metric.probability_of_violation, metric.monte_carlo_se
    if p is not None and error is not None and is_borderline(loop, metric):
        return " ± ".join(error_cells(p, error))
    return chance_of_missing(metric) or MISSING


def is_borderline(loop: LoopMargins, metric: Metric) -> bool:
    """Tell whether the Monte Carlo error decides whether a spec is missed too often."""
    p, error = metric.probability_of_violation, metric.monte_carlo_se
    allowed = loop.violation_probability_max
    if metric.name == "gamma_hunting" or metric.spec is None or allowed is None:
        return False
    return p is not None and error is not None and 0 < p < 1 and abs(p - allowed) < TWICE * error


def spaced(number: str, unit: str) -> str:
    """Return a number with its unit, after a thin space unless it is a degree."""
    return f"{number}{unit}" if unit in ("", "°") else f"{number}\u202f{unit}"


def _allowed(loop: LoopMargins, metric: Metric) -> str:
    """Return with which probability the loop's file allows that a metric misses its spec."""
    hunting = metric.name == "gamma_hunting"
    allowed = loop.limit_cycle_probability_max if hunting else loop.violation_probability_max
    return MISSING if allowed is None else f"{allowed:g}"

"""The metrics of a loop as rows of ``margins.json``, each with its notes."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from bayesfric.arrays import Array
from bayesfric.margins.cable_run import Direction
from bayesfric.margins.describing import effective_damping, steady_error
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.margin_rules import MARGIN_RULES
from bayesfric.margins.metric_definitions import HUNTING, LINEAR, PEAKS, RULES, TAUT, Rule
from bayesfric.margins.metrics import Linear, closed_forms, spec_of
from bayesfric.margins.terms import standard_error
from bayesfric.margins.thresholds import GAMMA_MAX, Hunting
from bayesfric.schemas.base import Interval
from bayesfric.schemas.margins import QUANTILE_LEVELS, Metric

ROUNDING = 1e-9
"""Relative spread below which draws count as equal up to rounding."""
OF_ALL = "of all motors that turn this joint, each at its worst"
WRIST_NOTES = {
    "steady_error_servo": OF_ALL,
    "lost_motion": OF_ALL,
    "reversal_error": "of the motors that move along with this joint alone",
    "cable_stretch": "of the cables of all motors",
    "backdrive_force": "with the other joints held: the motors that move along give way, too",
}


def metric_rows(
    shaft: LoopAtShaft,
    linear: Mapping[Direction | None, Linear],
    hunting: Hunting,
    effective_draws: float,
) -> tuple[Metric, ...]:
    """Return the rows of ``margins.json``, in a fixed order.

    Parameters
    ----------
    shaft : LoopAtShaft
        The loop, all draws.
    linear : mapping
        The result of :func:`linear_of`.
    hunting : Hunting
        Thresholds of hunting of the draws.
    effective_draws : float
        Number of independent draws that the values are worth, for the Monte Carlo error.
    """
    simulated = {
        "gamma_hunting": hunting.threshold,
        "limit_cycle_amplitude": hunting.amplitude,
        "limit_cycle_frequency": hunting.frequency,
    }
    values, rows = closed_forms(shaft, linear), []
    for rule in RULES:
        directions = shaft.directions if rule.name in LINEAR else (None,)
        for direction in directions:
            value = simulated.get(rule.name, values.get((rule.name, direction)))
            about = _About(rule, direction, shaft, linear, hunting)
            rows.append(_row(about, value, effective_draws))
    return tuple(rows)


class _About(NamedTuple):
    """The subject of a row: a metric in a direction, and the loop."""

    rule: Rule
    direction: Direction | None
    shaft: LoopAtShaft
    linear: Mapping[Direction | None, Linear]
    hunting: Hunting


def is_constant(values: Array) -> bool:
    """Return whether the spread of draws is only rounding."""
    return bool(np.ptp(values) <= ROUNDING * np.abs(values).max())


def interval_of(values: Array) -> Interval:
    """Return the five numbers of a distribution, without spread if the spread is only rounding."""
    if is_constant(values):
        return Interval.of(values[0], 0.0, np.full(3, values[0]))
    return Interval.of_draws(values, ddof=1)


def _row(about: _About, value: Array | None, effective_draws: float) -> Metric:
    rule, direction, shaft, linear, hunting = about
    spec = spec_of(rule, shaft)
    if rule.name == "gamma_hunting" and shaft.loop.compensation.signal != "none":
        spec = float(np.median(shaft.gamma))
    taut = shaft.taut if rule.name in TAUT else np.ones(shaft.friction.shape, dtype=bool)
    slack = int(taut.size - taut.sum())
    fields = {
        "name": rule.name,
        "unit": rule.unit,
        "place": rule.place,
        "direction": direction,
        "sense": rule.sense,
        "spec": spec,
    }
    missing = _missing(rule.name, value, shaft, hunting)
    if rule.name in LINEAR and not linear[direction].stable.any():
        value, missing = None, "the loop is unstable without friction, in every draw"
    if value is not None and slack:
        value, missing = value[taut], "a side of the pair goes slack in every draw"
    if value is None or value.size == 0:
        whys = ("interval_why", "probability_of_violation_why", "monte_carlo_se_why")
        return Metric(**fields, interval=None, **dict.fromkeys(whys, missing))
    draws = min(effective_draws, float(value.size))
    probability = _probability_of_violation(rule, spec, value, hunting, slack)
    finite = value[np.isfinite(value)]
    # an oscillation exists in some draws only; other metrics need a value in every draw
    conditional = rule.name in ("amplitude_margin", *HUNTING)
    shown = finite if conditional or finite.size == value.size else finite[:0]
    interval = interval_of(shown) if shown.size else None
    error = None
    if probability is not None:
        error = standard_error(probability, draws)
    elif interval is not None:
        error = interval.sd / float(np.sqrt(min(draws, shown.size)))
    return Metric(
        **fields,
        interval=interval,
        interval_why=None if interval is not None else missing,
        quantiles=_quantiles(shown, interval),
        probability_of_violation=probability,
        probability_of_violation_why=None if probability is not None else "nothing is asked for",
        monte_carlo_se=error,
        monte_carlo_se_why=None if error is not None else missing,
        note=_note(about, interval, value, finite),
    )


def _probability_of_violation(
    rule: Rule, spec: float | None, value: Array, hunting: Hunting, slack: int
) -> float | None:
    """Return the probability that a spec is missed; draws in which a side goes slack miss it."""
    if spec is None:
        return None
    violated = hunting.now if rule.name == "gamma_hunting" else rule.misses(value, spec)
    return float((violated.sum() + slack) / (violated.size + slack))


def _quantiles(values: Array, interval: Interval | None) -> tuple[float, ...]:
    """Return the stored quantiles; none without an interval, one number without spread."""
    if interval is None:
        return ()
    if interval.sd == 0:
        return (interval.mean,) * len(QUANTILE_LEVELS)
    return tuple(map(float, np.quantile(values, QUANTILE_LEVELS)))


def _missing(name: str, value: Array | None, shaft: LoopAtShaft, hunting: Hunting) -> str:
    """Return why a metric has no interval."""
    if name == "smallest_step" and shaft.wrist is not None:
        return "not examined: a step of a coupled joint is one of several motors at once"
    if name == "headroom_continuous":
        return "drive.continuous_current_a is not given"
    if name in HUNTING:
        if name != "gamma_hunting" and hunting.now.any():
            return (
                f"{hunting.now.mean():.1%} of the draws hunt, for fewer than "
                f"{MARGIN_RULES.swing_least_cycles:g} cycles in the half of a run that is looked at"
            )
        looked = f"{hunting.rows.size} draws hunts, at {len(hunting.speeds)} reference speeds"
        if shaft.loop.compensation.signal == "none":
            return f"there is no compensation, and none of {looked}"
        if name == "gamma_hunting":
            return f"none of {looked}, up to γ = {GAMMA_MAX:g}"
        return f"none of {looked}, at γ = {np.median(shaft.gamma):.3g}"
    if name == "amplitude_margin":
        unknown = 0.0 if value is None else float(np.isnan(value).mean())
        if unknown > 0:
            return f"not known: b_eff does not tell it in {unknown:.1%} of the draws"
        return "b_eff is positive in every draw: the loop is damped without friction"
    if name in PEAKS and value is not None:
        return f"{np.mean(~np.isfinite(value)):.1%} of the draws are unstable without friction"
    share = 0.0 if value is None else float(np.mean(~np.isfinite(value)))
    return f"{share:.1%} of the draws have no such crossing"


def _note(about: _About, interval: Interval | None, value: Array, finite: Array) -> str:
    rule, direction, shaft, linear, hunting = about
    notes = [rule.note] if rule.note else []
    if rule.name in TAUT and not shaft.taut.all():
        notes.append(f"in the {shaft.taut.mean():.1%} of the draws in which both sides stay taut; "
                     "the others count as missing a spec")  # fmt: skip
    if shaft.wrist is not None and rule.name in WRIST_NOTES:
        notes.append(WRIST_NOTES[rule.name])
    match rule.name:
        case "friction_nominal" | "friction_recursive":
            used = {run.model for _, run in shaft.loop.every_run}
            if used == {rule.name.removeprefix("friction_")}:
                notes.append("the loop uses this one")
            if len(shaft.stages) == 2:
                notes.append("of both cables, as a force on the cable at the motor")
        case "steady_error_servo":
            error = float(np.median(steady_error(shaft)))
            counts = error * float(np.median(shaft.counts)) / (2 * np.pi)
            notes.append(f"{error:.3g} rad at the motor, {counts:.0f} counts (median)")
            if (shaft.net_load != 0).any():
                part = np.median(np.abs(shaft.net_load) / (shaft.kp * steady_error(shaft)))
                notes.append(f"{part:.0%} of it is the load (median)")
            if (shaft.ki > 0).any():
                notes.append("an integral works it off, if the loop does not hunt")
            elif shaft.loop.compensation.signal in ("measured", "reference"):
                notes.append("computed without the compensator, which may be off or wrong at rest")
        case "gamma_hunting" | "limit_cycle_amplitude" | "limit_cycle_frequency":
            notes.append(hunting.note)
            if rule.name == "gamma_hunting" and finite.size < value.size:
                notes.append(f"{1 - finite.size / value.size:.1%} of the draws do not hunt up to "
                             f"γ = {GAMMA_MAX:g} and are left out")  # fmt: skip
            elif rule.name != "gamma_hunting" and finite.size:
                notes.append(
                    f"in the {finite.size / value.size:.1%} of the draws that hunt for "
                    f"{MARGIN_RULES.swing_least_cycles:g} cycles at "
                    f"γ = {np.median(shaft.gamma):.3g}"
                )
        case "amplitude_margin" if finite.size:
            share = float((effective_damping(shaft) < 0).mean())
            notes.append(f"in the {share:.1%} of the draws that friction alone holds still")
            if np.isnan(value).any():
                notes.append(f"not known in the {np.isnan(value).mean():.1%} in which b_eff does "
                             "not tell it; they count as missing a spec")  # fmt: skip
        case name if name in LINEAR:
            notes += _linear_notes(linear[direction], interval, direction)
    return "; ".join(notes)


def _linear_notes(
    linear: Linear, interval: Interval | None, direction: Direction | None
) -> list[str]:
    notes = []
    if interval is not None and interval.sd == 0:
        notes.append(
            "Coulomb friction is not in the linear loop at constant tension, and nothing else in "
            "the loop is uncertain: one number, not a distribution"
        )
    elif direction is None:
        notes.append("it spreads with the loop's own numbers: Coulomb friction has no part in it")
    else:
        notes.append(
            "in an open run friction weights the load side by 1/η or η, so c1 and c3 move it"
        )
    if not linear.stable.all():
        notes.append(f"{1 - linear.stable.mean():.1%} of the draws are unstable without friction "
                     "and have no such margin")  # fmt: skip
    if (linear.crossings[linear.stable] > 1).any():
        notes.append("of several gain crossings, the smallest is used")
    return notes

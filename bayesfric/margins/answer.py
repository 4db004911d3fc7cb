"""Which compensation gain to set."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bayesfric.arrays import Array, Flags
from bayesfric.margins.describing import necessary_gain
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.loop_file import Spec
from bayesfric.margins.margin_rules import MARGIN_RULES
from bayesfric.margins.metric_definitions import HUNTS, full_name
from bayesfric.margins.scanning import REST, Condition
from bayesfric.margins.terms import FEW_DRAWS, MEASURE_IT, chance_of_missing, standard_error
from bayesfric.margins.thresholds import GAMMA_MAX, Hunting
from bayesfric.probabilities import ROUNDING, bound_of, bound_of_hits, percent, stated_of_draws
from bayesfric.schemas.margins import GammaProbability, Metric

STEP = 0.05
LEAST_MAY_HUNT = 5
"""Least number of draws that may hunt; with fewer, their number does not give a probability."""
CALLED = {"steady_error_servo": "steady error of the servo"}


@dataclass(frozen=True)
class SafeGain:
    """The largest γ with P(limit cycle) within a bound.

    Parameters
    ----------
    gamma : float or None
        None where there is none.
    se : float or None
        Its Monte Carlo standard error.
    why : str or None
        Why there is none.
    condition : Condition or None
        The condition in which the deciding draws hunt; None if no draw hunts.
    """

    gamma: float | None
    se: float | None
    why: str | None
    condition: Condition | None = None


def limit_cycle_curve(hunting: Hunting, effective_draws: float) -> tuple[GammaProbability, ...]:
    """Return P(limit cycle) over γ from 0 to :data:`GAMMA_MAX`."""
    draws = min(effective_draws, float(hunting.threshold.size))
    curve = []
    for gamma in np.arange(0.0, GAMMA_MAX + STEP / 2, STEP):
        p = float((hunting.threshold <= gamma).mean())
        curve.append(GammaProbability(gamma=round(float(gamma), 4), p=p,
                                      mcse=standard_error(p, draws)))  # fmt: skip
    return tuple(curve)


def largest_safe_gain(hunting: Hunting, allowed: float, effective_draws: float) -> SafeGain:
    """Return the largest γ at which at most a share of the draws hunts.

    Parameters
    ----------
    hunting : Hunting
        Thresholds of the draws.
    allowed : float
        The share.
    effective_draws : float
        Number of independent draws that they are worth.
    """
    ordered = np.sort(hunting.threshold)
    tolerance, cut = MARGIN_RULES.threshold_tolerance, MARGIN_RULES.threshold_share
    count = ordered.size

    def at(share: float) -> float:
        """Return a γ below which `share` of the draws hunt, less the error of the thresholds."""
        place = int(np.floor(share * count + 1e-9))
        most = float(ordered[place]) if place < count else np.inf
        return min(most - tolerance, most * (1 - cut), GAMMA_MAX)

    first = hunting.condition[np.argsort(hunting.threshold, kind="stable")]
    deciding = first[: int(allowed * count) + 1]
    deciding = deciding[deciding >= 0]
    condition = None
    if deciding.size:
        condition = hunting.conditions[int(np.bincount(deciding).argmax())]
    if at(allowed) <= 0.0:
        why = f"{percent(float((ordered <= 0).mean()))} of the draws hunt without any compensation"
        if (ordered <= 0).mean() <= allowed:
            early = percent(float((ordered <= tolerance).mean()))
            why = f"{early} of the draws hunt already at γ = {tolerance:g}"
        why += ", after the kick"
        return SafeGain(None, None, why, condition)
    error = standard_error(allowed, min(effective_draws, float(count)))
    low, high = at(max(allowed - error, 0.0)), at(min(allowed + error, 1.0))
    return SafeGain(at(allowed), max((high - low) / 2, tolerance), None, condition)


def which_gain(shaft: LoopAtShaft, hunting: Hunting, safe: SafeGain, allowed: float) -> str:
    """Return which compensation gain to set, in sentences."""
    needed = necessary_gain(shaft)
    signal = shaft.loop.compensation.signal
    how = {"formula": "by formula", "simulation": "simulated"}[hunting.method]
    where = _range(hunting, shaft)
    decided = "" if safe.condition is None else f"; the worst is {_worded(safe.condition, shaft)}"
    missing = f" Not examined: {'; '.join(hunting.not_examined)}."
    if signal == "none":
        now = f"It hunts in {share_of(hunting.now)}, {where} ({how})"
        none = "There is no gain to set: the loop has no friction compensation."
        return f"{none} {now}{decided}.{missing}"
    if safe.gamma is None:
        return f"No γ is safe: {safe.why}, {where} ({how}){decided}.{missing}"
    if safe.gamma >= GAMMA_MAX:
        if signal == "reference":
            over = float(np.quantile(needed, allowed))
            beyond = (f"above γ = {over:.2f} it over-compensates with a probability of more than "
                      f"{percent(allowed)}, which biases")  # fmt: skip
        else:
            beyond = f"above γ = {float(np.median(needed)):.2f} (median) it over-compensates"
        hunting_share = share_of(hunting.threshold <= GAMMA_MAX)
        return (
            f"Up to γ = {GAMMA_MAX:g} the loop hunts in {hunting_share}, {where} "
            f"({how}); {beyond}.{missing}"
        )
    return (
        f"Set γ to {np.floor(100 * safe.gamma) / 100:.2f} at most (Monte Carlo error "
        f"{safe.se:.2f}): up to there the loop hunts with a probability of {percent(allowed)} or "
        f"less, {where} ({how}){decided}.{_of_few_draws(hunting, allowed)} "
        f"{_now(shaft, hunting)}{missing}"
    )


def _of_few_draws(hunting: Hunting, allowed: float) -> str:
    """Return the bound of the draws on the probability, if too few of them may hunt."""
    draws = hunting.threshold.size
    may_hunt = allowed * draws
    if may_hunt >= LEAST_MAY_HUNT:
        return ""
    bound = bound_of_hits(int(may_hunt + ROUNDING), draws)
    return (
        f" Of {draws} draws {percent(allowed)} are {may_hunt:.2g}, {FEW_DRAWS} only at "
        f"{percent(bound)}, at 95 % confidence."
    )


def _now(shaft: LoopAtShaft, hunting: Hunting) -> str:
    """Return the probability of hunting at the γ of the file, and the worst condition."""
    gamma = f"{np.median(shaft.gamma):.3g}"
    if not hunting.now.any():
        return f"At γ = {gamma}, as in the file, it hunts in {share_of(hunting.now)}."
    by_speed = hunting.hunts.mean(axis=1)
    most = int(by_speed.argmax())
    worst = _worded(hunting.speeds[most], shaft)
    now = f"At γ = {gamma}, as in the file, it hunts in {share_of(hunting.now)}"
    if np.array_equal(hunting.hunts[most], hunting.now):
        return f"{now}, all of them with {worst}."
    return f"{now} at some speed, in {share_of(hunting.hunts[most])} with {worst}."


def against_the_spec(
    metrics: Sequence[Metric], missed: Sequence[str], now: Flags, spec: Spec
) -> str:
    """Return whether the loop meets the specs of its file, in a sentence.

    Parameters
    ----------
    metrics : sequence of Metric
        Metrics of the loop.
    missed : sequence of str
        As returned by :func:`~bayesfric.margins.metric_definitions.missed_specs`.
    now : ndarray of bool
        Which draws hunt at the γ of the file.
    spec : Spec
        Specs of the file.
    """
    chances = {
        full_name(metric): chance_of_missing(metric)
        for metric in metrics
        if metric.spec is not None
    }
    chances.pop("gamma_hunting", None)
    chances[HUNTS] = stated_of_draws(float(now.mean()), now.size)
    if not missed:
        return (
            f"Meets its spec: each of {len(chances)} metrics with a probability of "
            f"{percent(1 - max(spec.violation_probability_max, spec.limit_cycle_probability_max))} "
            "or more."
        )
    likeliest = (
        f"{CALLED.get(name, name).replace('_', ' ')} ("
        + ("no draw has one)" if (chance := chances[name]) is None else f"{_equals(chance)})")
        for name in missed
    )
    return (
        f"Misses {len(missed)} of {len(chances)} specs, each with a probability P: "
        f"{', '.join(likeliest)}."
    )


def _equals(chance: str) -> str:
    return f"P {chance}" if chance[0] in "<>" else f"P = {chance}"


def what_to_measure(shares: Mapping[str, Mapping[str, float]]) -> Iterator[str]:
    """Yield the assumed number that contributes most to the variance of friction, if much."""
    of_friction = shares.get("gamma_necessary") or shares.get("steady_error_servo") or {}
    own = {key: share for key, share in of_friction.items() if "." in key}
    if own:
        key = max(own, key=lambda group: own[group])
        if own[key] >= MARGIN_RULES.worth_measuring:
            yield (
                f"The assumed {key} contributes {own[key]:.0%} of the variance of friction"
                f"{MEASURE_IT}"
            )


def share_of(happened: Flags) -> str:
    """Return a share of draws in words; for none and for all, its 95 % bound."""
    count, hits = happened.size, int(happened.sum())
    bound = 100 * bound_of(count)
    if hits == 0:
        return f"0 of {count} draws (at 95 % confidence, in less than {bound:.2g} %)"
    if hits == count:
        return f"{count} of {count} draws (at 95 % confidence, in more than {100 - bound:.3g} %)"
    error = standard_error(hits / count, count)
    return f"{100 * hits / count:.3g} % (± {100 * error:.1g} %) of the draws"


def _range(hunting: Hunting, shaft: LoopAtShaft) -> str:
    if hunting.speeds == (REST,):
        return "with the reference at rest"
    fastest = hunting.speeds[-1].speed_of(shaft)
    slowest = hunting.speeds[1].speed_of(shaft)
    return (
        f"with references at rest and from {np.median(slowest):.2g} to {np.median(fastest):.3g} "
        f"rad/s of the motor ({_at_tip(slowest, shaft)} to {_at_tip(fastest, shaft)} at the tip)"
    )


def _worded(condition: Condition, shaft: LoopAtShaft) -> str:
    """Return a condition in words."""
    speed, kick = condition.speed_of(shaft), condition.kick_of(shaft)
    at = "a reference at rest"
    if speed.any():
        at = f"a reference of {np.median(speed):.2g} rad/s ({_at_tip(speed, shaft)} at the tip)"
    after = f"after a kick of {np.median(kick):.2g} rad" if kick.any() else "without a kick"
    return f"{at} {after}"


def _at_tip(speed: Array, shaft: LoopAtShaft) -> str:
    return f"{1e3 * float(np.median(speed * shaft.tip_per_rad)):.2g} mm/s"

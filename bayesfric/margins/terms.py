"""Margins as engineers read them: gains in decibels, phases in degrees, a setting in words."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from bayesfric.margins.metric_definitions import HUNTS, full_name
from bayesfric.probabilities import stated_of_draws
from bayesfric.schemas.base import Interval
from bayesfric.schemas.margins import GammaProbability, LoopMargins, Metric, Tuning

HALF_A_DRAW = float(np.sqrt(0.5))
"""Monte Carlo error of a property that none or all of n draws have: this over n."""
FEW_DRAWS = "so that they bound it"
"""Part of the sentence that says that a safe gain rests on too few draws."""
MEASURE_IT = ": measure it."
"""End of the sentence on the number to which a result is most sensitive."""
NORMAL_WIDTH = 3.29
"""Distance from the 5 to the 95 % quantile of a normal, in standard deviations."""
TURNED: Mapping[str, tuple[str, Callable[[float], float]]] = {
    "phase_margin": ("deg", lambda radians: float(np.rad2deg(radians))),
    "gain_margin": ("dB", lambda factor: float(20 * np.log10(factor))),
}
"""Unit and conversion, by metric."""


def standard_error(probability: float, draws: float) -> float:
    """Return the Monte Carlo error of a probability; for 0 and 1 that of half a draw."""
    p = min(max(probability, 0.5 / draws), 1 - 0.5 / draws)
    return float(np.sqrt(p * (1 - p) / draws))


def draws_behind(curve: Sequence[GammaProbability]) -> float:
    """Return the effective number of draws, from which the Monte Carlo errors of a curve follow."""
    counts = [
        point.p * (1 - point.p) / point.mcse**2 if 0 < point.p < 1 else HALF_A_DRAW / point.mcse
        for point in curve
    ]
    return min(counts)


def chance_of_missing(metric: Metric) -> str | None:
    """Return the probability of missing the spec of a metric, in words; None without a spec."""
    p, error = metric.probability_of_violation, metric.monte_carlo_se
    if p is None or error is None:
        return None
    return stated_of_draws(p, HALF_A_DRAW / error)


def in_degrees_or_decibels(metric: Metric) -> Metric | None:
    """Return a gain margin in dB or a phase margin in degrees; None for any other metric.

    Quantiles are converted. The mean and the spread in decibels are those of the normal with the
    converted 5 and 95 % quantiles.

    Parameters
    ----------
    metric : Metric
        The metric as stored, in SI units.
    """
    turning = TURNED.get(metric.name)
    if turning is None:
        return None
    unit, turned = turning
    interval = metric.interval
    if interval is not None:
        low, middle, high = (turned(value) for value in (interval.q05, interval.q50, interval.q95))
        interval = Interval.of(middle, (high - low) / NORMAL_WIDTH, np.array([low, middle, high]))
    return metric.model_copy(
        update={
            "unit": unit,
            "interval": interval,
            "spec": None if metric.spec is None else turned(metric.spec),
            "quantiles": tuple(turned(value) for value in metric.quantiles),
        }
    )


def safety_words(loop: LoopMargins) -> str:
    """Return whether a loop is safe at the gain of its file and meets its spec, in a few words."""
    missed = loop.missed_specs or ()
    at = "" if loop.compensation_signal == "none" else f" at γ = {loop.compensation_gain:.3g}"
    if HUNTS in missed:
        return f"not safe{at}"
    return f"safe from hunting{at}, {'but misses' if missed else 'and meets'} its spec"


def is_missed(loop: LoopMargins, metric: Metric) -> bool:
    """Return whether a metric misses its spec more often than the loop's file allows."""
    name = full_name(metric)
    own = HUNTS if metric.name == "gamma_hunting" else name
    return metric.spec is not None and bool({name, own} & {*(loop.missed_specs or ())})


def safe_up_to(loop: LoopMargins) -> str | None:
    """Return the largest safe γ, rounded down; None if there is none."""
    gamma = loop.largest_safe_compensation_gain
    if gamma is None:
        return None
    down = rounded_down(gamma)
    return f"{down:g}" if gamma >= loop.limit_cycle_probability[-1].gamma else f"{down:.2f}"


def rounded_down(gamma: float) -> float:
    """Return a γ rounded down to two decimals."""
    return float(np.floor(100 * gamma) / 100)


def at_safe_gain_words(loop: LoopMargins, called: Callable[[str, str], str]) -> str:
    """Return which specs hold at the safe γ if the file's γ is larger; else an empty text.

    Parameters
    ----------
    loop : LoopMargins
        The margins as stored.
    called : callable
        (name of a metric, its direction or an empty text) to its words.
    """
    gamma, up_to = loop.largest_safe_compensation_gain, safe_up_to(loop)
    if gamma is None or gamma >= loop.compensation_gain:
        return ""
    there = loop.at_safe_gain
    if there is not None and not there.missed_specs:
        return f"At γ = {up_to} every spec is met."
    if there is not None:
        missed = [called(*name.partition(" ")[::2]) for name in there.missed_specs]
        count = len({HUNTS, *there.missed_specs, *map(full_name, there.metrics)})
        rest = ", and meets its other specs" if len(missed) < count else ""
        return f"At γ = {up_to} it still misses {' and '.join(missed)}{rest}."
    return (  # in files of earlier versions
        f"All specs are evaluated at γ = {loop.compensation_gain:.3g}; to see which hold at γ = "
        f"{up_to}, set it in the loop's file and run again."
    )


def certificate_sentence(loop: LoopMargins) -> str | None:
    """Return the certificate of a loop, or why there is none; None in files of earlier versions."""
    if loop.certificate is not None:
        return loop.certificate.sentence
    why = loop.certificate_why
    return why and f"Circle criterion: not applicable, since {why}."


def tuning_sentence(tuning: Tuning) -> str:
    """Return the setting that meets all specs at once, in a sentence, or why there is none."""
    chance = f"{tuning.probability:.2g} (± {tuning.probability_se:.1g})"
    if tuning.kp_scale is None or tuning.kd_scale is None:
        return f"No setting: {tuning.why}; all are met at once with probability {chance}."
    edge = ", the largest that was looked at" if tuning.stiffest_looked_at else ""
    gain = (
        f"no γ, since {tuning.compensation_gain_why}"  # in files of earlier versions
        if tuning.compensation_gain is None
        else f"γ = {tuning.compensation_gain:.2f}"
    )
    return (
        f"Stiffest setting that meets all specs at once: kp × {tuning.kp_scale:.3g}{edge}, kd × "
        f"{tuning.kd_scale:.3g}, {gain}: with probability {chance}."
    )

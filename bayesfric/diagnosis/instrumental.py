"""Reports instrumental-variable estimates where least squares differ from them.

Errors of an encoder, and disturbances inside a joint's control loop, are in the regressors of least
squares and bias it. If the two estimates differ by more than chance (the instrument alarms), the
law of the instrument is reported (IDIM-IV), and biased numbers cannot show that there is no gap.

References
----------
A. Janot, P.-O. Vandanjon, M. Gautier, "A generic instrumental variable approach for industrial
robot identification", IEEE Transactions on Control Systems Technology 22 (1), 2014.
"""

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np

from bayesfric.diagnosis.law import FRICTION, RunScatter
from bayesfric.diagnosis.widening import UNCHANGED, Factors, open_below, wider
from bayesfric.diagnosis_rules import RULES
from bayesfric.effects import Effect
from bayesfric.effects.candidates import is_positive
from bayesfric.inference.truncated import normal_above
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import INERTIAS, SIGNED, Cause, LawNumber
from bayesfric.schemas.instrument import Instrument, InstrumentNumber

NOTHING_WIDER: Factors = MappingProxyType({})


def why_biased(instrument: Instrument | str) -> str | None:
    """Return why least squares cannot show that there is no gap; None if they can.

    Parameters
    ----------
    instrument : Instrument or str
        Estimates by an instrument, or why there are none.
    """
    if isinstance(instrument, str) or not instrument.alarms:
        return None
    return (
        "encoder errors, or disturbances inside the control loop, bias the law by more than that "
        f"(Durbin-Wu-Hausman test: p = {instrument.p_value:.1g})"
    )


def why_uncorrected(instrument: Instrument | str) -> str | None:
    """Return why the control loop may bias the law beyond repair; None if it does not.

    Instruments of any strength can show a bias of least squares; only a strong instrument
    determines its size.

    Parameters
    ----------
    instrument : Instrument or str
        Estimates by an instrument, or why there are none.
    """
    if isinstance(instrument, str) or instrument.alarms:
        return None
    if instrument.p_value >= RULES.instrument_sure or instrument.strength >= RULES.instrument_weak:
        return None
    return (
        "encoder errors, or disturbances inside the control loop, bias least squares "
        f"(Durbin-Wu-Hausman test: p = {instrument.p_value:.1g}), and the earlier motion is too "
        f"weak an instrument to correct that (F = {instrument.strength:.2g}): log the reference"
    )


def why_unconfirmed(instrument: Instrument | str, named: Mapping[str, str]) -> str | None:
    """Return which causes an alarming instrument does not confirm; None if it confirms all.

    Parameters
    ----------
    instrument : Instrument or str
        Estimates by an instrument, or why there are none.
    named : mapping of str to str
        The causes by least squares, each with the effect whose law it has (itself or a twin).
    """
    if isinstance(instrument, str):
        return None
    if not instrument.alarms and why_uncorrected(instrument) is None:
        return None
    parts = []
    for name, whose in named.items():
        value = instrument.effects.get(whose)
        if value is None:
            parts.append(f"it does not determine {name}")
        elif not _confirms(value):
            unit = "" if value.unit == "1" else f" {value.unit}"
            parts.append(
                f"{name} is {value.instrumental:.2g} ± {value.instrumental_se:.1g}{unit} by it, "
                f"and {value.ordinary:.2g}{unit} by least squares"
            )
    if not parts:
        return None
    return (
        "the instrumental-variable estimate, which encoder errors and the control loop do not "
        f"bias, differs from least squares (Durbin-Wu-Hausman test: p = {instrument.p_value:.1g}): "
        f"{'; '.join(parts)}"
    )


def _confirms(value: InstrumentNumber) -> bool:
    """Return whether the instrument's amplitude is significant and not much below least squares."""
    ordinary, instrumental = value.ordinary, value.instrumental * np.sign(value.ordinary)
    return bool(
        instrumental > RULES.instrument_errors * value.instrumental_se
        and instrumental > RULES.instrument_keeps * abs(ordinary)
    )


def by_the_instrument(
    law: Mapping[str, LawNumber],
    instrument: Instrument | str,
    factors: Factors = NOTHING_WIDER,
    scatter: RunScatter | None = None,
) -> dict[str, LawNumber]:
    """Return the numbers of a law, with the instrument's estimates if it alarms.

    If the instrument shows a bias but is too weak to correct it, errors are increased by the
    estimated bias.

    Parameters
    ----------
    law : mapping of str to LawNumber
        By least squares.
    instrument : Instrument or str
        Estimates by an instrument, or why there are none.
    factors : mapping of str to tuple of float
        Factors by which intervals are wider than fitted; they apply to the instrument's too.
    scatter : RunScatter or None
        Scatter of friction from run to run, which the instrument's errors do not contain.
    """
    unsettled = why_uncorrected(instrument) is not None
    if isinstance(instrument, str) or not (instrument.alarms or unsettled):
        return dict(law)
    numbers = dict(law)
    for name, number in law.items():
        value = instrument.numbers.get("inertia" if name in INERTIAS else name)
        if value is None:
            continue
        if unsettled or (name not in SIGNED and value.instrumental <= 0):
            numbers[name] = _by_as_much(name, number, value)
            continue
        error = value.instrumental_se * factors.get(name, UNCHANGED)[1]
        if scatter is not None and name in FRICTION:
            of_runs = value.instrumental * scatter.share / np.sqrt(scatter.runs)
            error = float(np.hypot(error, of_runs))
        numbers[name] = _instrumental_number(name, number, value.instrumental, error)
    return numbers


def causes_by_the_instrument(
    causes: Sequence[Cause], instrument: Instrument | str, examined: Mapping[str, Effect]
) -> tuple[Cause, ...]:
    """Return causes, with the instrument's amplitudes if it alarms.

    Parameters
    ----------
    causes : sequence of Cause
        By least squares.
    instrument : Instrument or str
        Estimates by an instrument, or why there are none.
    examined : mapping of str to Effect
        All examined effects.
    """
    if isinstance(instrument, str) or not instrument.alarms:
        return tuple(causes)
    amended: list[Cause] = []
    for cause in causes:
        key = next(iter(cause.parameters))  # for a twin's law: TWIN.NAME
        whose = key.rpartition(".")[0] or cause.effect
        value, effect = instrument.effects.get(whose), examined.get(whose, examined[cause.effect])
        if value is None or key.rpartition(".")[2] != effect.amplitude.name:
            amended.append(cause)
            continue
        least = 0.0 if is_positive(effect.amplitude.prior) else -np.inf
        before = cause.parameters[key]
        # The instrument's fit fixes the shape; the posterior sd contains the shape's error too.
        shape2 = max((before.sd or 0.0) ** 2 - value.ordinary_se**2, 0.0)
        error = float(np.hypot(value.instrumental_se, np.sqrt(shape2)))
        amplitude = Interval.of(*normal_above(value.instrumental, error, least))
        number = before.model_copy(update=amplitude.model_dump())
        low, high = cause.plausible_range
        changed = {
            "parameters": cause.parameters | {key: number},
            "plausible": low <= number.q50 <= high,
            "strength": cause.strength * abs(number.q50 / before.q50) if before.q50 else 0.0,
        }
        amended.append(cause.model_copy(update=changed))
    return tuple(amended)


def _by_as_much(name: str, number: LawNumber, value: InstrumentNumber) -> LawNumber:
    """Return a number whose error includes the estimated bias of least squares."""
    bend, sd = abs(value.instrumental - value.ordinary), number.after.sd
    factor = float(np.hypot(1.0, bend / sd)) if sd > 0 else 1.0
    return number.model_copy(update={"after": wider(number.after, factor, name)})


def _instrumental_number(name: str, number: LawNumber, mean: float, error: float) -> LawNumber:
    least = -np.inf if name in SIGNED else 0.0
    after = Interval.of(*normal_above(mean, error, least))
    after = after if name in SIGNED else open_below(after)
    changed = {"after": after, "least_squares": number.after, "least_squares_why": None}
    return number.model_copy(update=changed)

"""What is told where an instrument and least squares are apart: the instrument's numbers.

Errors of an encoder, and what disturbs a joint inside its controller's loop, are in the regressors
of least squares. Where these two are apart by more than chance, the law of the instrument is the
one to use (IDIM-IV), and nothing is said to leave no gap by numbers that are bent.

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


def why_bent(instrument: Instrument | str) -> str | None:
    """Return why the law by least squares says of no gap that it is none; None where it may.

    Parameters
    ----------
    instrument : Instrument or str
        Beside least squares, or why there is none.
    """
    if isinstance(instrument, str) or not instrument.alarms:
        return None
    return (
        "encoder errors, or disturbances inside the control loop, bias the law by more than that "
        f"(Durbin-Wu-Hausman test: p = {instrument.p_value:.1g})"
    )


def why_unsettled(instrument: Instrument | str) -> str | None:
    """Return why the loop may have made what is left, and nothing sets it right; None if not.

    That least squares are bent is sure by instruments of any strength; by how much is told by
    strong ones alone.

    Parameters
    ----------
    instrument : Instrument or str
        Beside least squares, or why there is none.
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


def not_held(instrument: Instrument | str, named: Mapping[str, str]) -> str | None:
    """Return which causes an instrument that alarms does not tell; None where it tells all.

    Parameters
    ----------
    instrument : Instrument or str
        Beside least squares, or why there is none.
    named : mapping of str to str
        The causes by least squares, each with the effect whose law it has: itself, or a twin.
    """
    if isinstance(instrument, str):
        return None
    if not instrument.alarms and why_unsettled(instrument) is None:
        return None
    parts = []
    for name, whose in named.items():
        value = instrument.effects.get(whose)
        if value is None:
            parts.append(f"it does not determine {name}")
        elif not _is_told(value):
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


def _is_told(value: InstrumentNumber) -> bool:
    """Return whether an effect acts by the instrument, about as much as by least squares."""
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
    """Return the numbers of a law, those that an instrument has as it tells them if it alarms.

    Where it is sure that least squares are bent, and too weak to set them right, errors are as
    large as it makes the bend.

    Parameters
    ----------
    law : mapping of str to LawNumber
        By least squares.
    instrument : Instrument or str
        Beside it, or why there is none.
    factors : mapping of str to tuple of float
        How many times wider than fitted the numbers are: so are the instrument's.
    scatter : RunScatter or None
        By how much friction differs from run to run, which an instrument does not say.
    """
    unsettled = why_unsettled(instrument) is not None
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
        numbers[name] = _number_told(name, number, value.instrumental, error)
    return numbers


def causes_by_the_instrument(
    causes: Sequence[Cause], instrument: Instrument | str, examined: Mapping[str, Effect]
) -> tuple[Cause, ...]:
    """Return causes, their amplitudes as an instrument tells them if it alarms.

    Parameters
    ----------
    causes : sequence of Cause
        By least squares.
    instrument : Instrument or str
        Beside them, or why there is none.
    examined : mapping of str to Effect
        All effects that are examined.
    """
    if isinstance(instrument, str) or not instrument.alarms:
        return tuple(causes)
    amended: list[Cause] = []
    for cause in causes:
        key = next(iter(cause.parameters))  # of a twin's law, TWIN.NAME
        whose = key.rpartition(".")[0] or cause.effect
        value, effect = instrument.effects.get(whose), examined.get(whose, examined[cause.effect])
        if value is None or key.rpartition(".")[2] != effect.amplitude.name:
            amended.append(cause)
            continue
        least = 0.0 if is_positive(effect.amplitude.prior) else -np.inf
        before = cause.parameters[key]
        # The instrument holds the shape, whose error the posterior has beside that of the noise.
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
    """Return a number with an error as large as least squares may be bent."""
    bend, sd = abs(value.instrumental - value.ordinary), number.after.sd
    factor = float(np.hypot(1.0, bend / sd)) if sd > 0 else 1.0
    return number.model_copy(update={"after": wider(number.after, factor, name)})


def _number_told(name: str, number: LawNumber, mean: float, error: float) -> LawNumber:
    least = -np.inf if name in SIGNED else 0.0
    after = Interval.of(*normal_above(mean, error, least))
    after = after if name in SIGNED else open_below(after)
    changed = {"after": after, "least_squares": number.after, "least_squares_why": None}
    return number.model_copy(update=changed)

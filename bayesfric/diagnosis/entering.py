"""Numbers to enter in a simulator of a driven joint, and the loss if it has no field for one."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from bayesfric.arrays import Array
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.residuals import Residuals
from bayesfric.diagnosis.systematic import Posterior
from bayesfric.rigs.rotary import is_relative, rotary_unit
from bayesfric.robots.fields import LOAD_FRICTION, fields_of
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import INERTIAS, Cause, LawNumber
from bayesfric.schemas.diagnosis import Enter, SimulatorField
from bayesfric.schemas.gap import Gap

OF_PULLEYS = "of pulleys it is the coefficients of the friction law that are entered, under `law`"
NO_JOINT = "no number of this law has a field in a simulator of joints"
EVERY_FIELD = "every simulator has a field for it"
NO_FORCE = "what it makes alone was not drawn"
NO_MODEL = "no model of the machine was given"
RATIO = (
    "it is relative to the servo's stiffness K, and no simulator has a field for such a ratio: "
    "multiply it by K"
)
NOT_IN_MODEL = "no joint of a model has such a number"
NAMES = {"inertia": INERTIAS, "armature": ("armature", "mass")}
"""Of a number of the law, those by which a rig may call it."""
SNIPPETS = {"load-friction.share": LOAD_FRICTION}
"""Callbacks that stand for what no simulator has a field for."""


def numbers_to_enter(
    model: LinearModel,
    law: Mapping[str, LawNumber],
    posterior: Posterior,
    causes: Sequence[Cause],
    gap: Gap,
    residuals: Residuals,
) -> tuple[tuple[Enter, ...], str | None]:
    """Return the numbers to enter, from the refit with the causes, or why there are none.

    Parameters
    ----------
    model : LinearModel
        The model in which the hypotheses were compared.
    law : mapping of str to LawNumber
        Numbers of the law, without and with the effects.
    posterior : Posterior
        Draws.
    causes : sequence of Cause
        The causes.
    gap : Gap
        Contains rms friction.
    residuals : Residuals
        Windows; from their speeds and accelerations follows the force of each number.
    """
    if model.data.rigs[0].has_pulleys:
        return (), OF_PULLEYS
    if not {"inertia", "armature", "coulomb"} & set(law):
        return (), NO_JOINT
    turns, has = residuals.turns, model.data.rigs[0].in_simulator
    motion = _Motion.of(residuals)
    entered = [
        _of_law(name, number.after, number.unit, has, motion) for name, number in law.items()
    ]
    for cause in causes:
        damping = _damping(model, posterior) if cause.effect == "viscous" else None
        if damping is not None:
            unit = rotary_unit("N s/m") if turns else "N s/m"
            entered.append(_of_law("viscous", Interval.of_draws(damping), unit, has, motion))
        else:
            entered += _of_effect(cause, gap, turns)
    if is_relative(model.data.unit):
        entered = [_over_stiffness(number) for number in entered]
    return tuple(entered), None


def _over_stiffness(number: Enter) -> Enter:
    """Return the number as a ratio to stiffness, for which no simulator has a field."""
    nowhere = dict.fromkeys(number.fields)
    without = {"fields": nowhere, "lost_without": None, "lost_without_why": RATIO}
    return number.model_copy(update=without)


class _Motion(NamedTuple):
    """Rms speed and acceleration over the recording's conditions."""

    turns: bool
    speed_rms: float
    acceleration_rms: float

    @classmethod
    def of(cls, residuals: Residuals) -> "_Motion":
        def rms(name: str) -> float:
            values = np.nan_to_num(residuals.covariates[name])
            return float(np.sqrt((residuals.weight * values**2).sum()))

        return cls(residuals.turns, rms("velocity"), rms("acceleration"))

    def force(self, name: str, value: float) -> float:
        """Return the rms force of a number of the law [N or N·m]."""
        by = {"viscous": self.speed_rms, "inertia": self.acceleration_rms}
        by["armature"] = self.acceleration_rms
        return abs(value) * by.get(name, 1.0)


def _fields(parameter: str, turns: bool) -> dict[str, SimulatorField | None]:
    return {
        simulator: None if entry is None else SimulatorField(**entry._asdict())
        for simulator, entry in fields_of(parameter, turns=turns).items()
    }


def _of_law(
    name: str, value: Interval, unit: str, has: Mapping[str, float], motion: _Motion
) -> Enter:
    """Return a number of the law to enter; the loss without it is its rms force."""
    called = next((own for own in NAMES.get(name, (name,)) if own in has), None)
    fields = _fields(name, motion.turns)
    everywhere = all(fields.values())
    return Enter(
        parameter=name,
        unit=unit,
        in_your_simulator=None if called is None else has[called],
        in_your_simulator_why=None if called is not None else NOT_IN_MODEL if has else NO_MODEL,
        value=value,
        fields=fields,
        lost_without=None if everywhere else motion.force(name, value.mean),
        lost_without_why=EVERY_FIELD if everywhere else None,
    )


def _of_effect(cause: Cause, gap: Gap, turns: bool) -> list[Enter]:
    """Return the parameters of an effect to enter; the loss without them is its rms force."""
    lost = cause.strength * gap.friction_rms if cause.strength > 0 else None
    entered = []
    for name, number in cause.parameters.items():
        parameter = f"{cause.effect}.{name}"
        fields = _fields(parameter, turns)
        everywhere = all(fields.values())
        entered.append(
            Enter(
                parameter=parameter,
                unit=number.unit,
                in_your_simulator_why=NOT_IN_MODEL,
                value=Interval.model_validate(
                    number.model_dump(include=set(Interval.model_fields))
                ),
                fields=fields,
                lost_without=None if everywhere else lost,
                lost_without_why=EVERY_FIELD if everywhere else NO_FORCE if lost is None else None,
                snippet=SNIPPETS.get(parameter),
            )
        )
    return entered


def _damping(model: LinearModel, posterior: Posterior) -> Array | None:
    """Return draws of a joint's damping if its effect is a fraction of Coulomb friction.

    The amplitude is relative to the Coulomb friction of the model's reference law.
    """
    slope, coulomb = posterior.amplitudes.get("viscous"), _coulomb(model)
    variants = {law.law for law in model.lawbook.get("viscous", ())}
    if slope is None or coulomb is None or not variants <= {"constant", "friction"}:
        return None
    return np.asarray(slope * coulomb)


def _coulomb(model: LinearModel) -> float | None:
    if len(model.layout.sizes) > 1:
        return None  # an axis with a bench: the amplitude is relative to the friction of both
    (size,) = model.layout.sizes
    names = [name for name, _ in model.data.law_numbers(size)]
    if "coulomb" not in names:
        return None
    return float(np.asarray(model.laws[size][names.index("coulomb")]))

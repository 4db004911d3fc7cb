"""What to enter in a simulator of a driven joint, and what is lost where it has no field."""

from collections.abc import Mapping, Sequence

import numpy as np

from bayesfric.arrays import Array
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.systematic import Posterior, interval
from bayesfric.rigs.rotary import rotary_unit
from bayesfric.schemas import Cause, Enter, Gap, LawNumber, SimulatorField

__all__ = ["numbers_to_enter"]

MUJOCO, ISAACLAB, SDF, URDF, DRAKE = SIMULATORS = ("mujoco", "isaaclab", "sdf", "urdf", "drake")
OF_PULLEYS = "of pulleys it is the coefficients of the friction law that are entered, under `law`"
NO_JOINT = "no number of this law has a field in a simulator of joints"
HAS_FIELD = "a simulator has a field for it"
NO_FORCE = "what it makes alone was not drawn"

DAMPING = {
    MUJOCO: "joint/@damping",
    ISAACLAB: "ActuatorBaseCfg.viscous_friction",
    SDF: "joint/axis/dynamics/damping",
    URDF: "joint/dynamics/@damping",
    DRAKE: "joint/dynamics/@damping",
}
FIELDS: dict[str, dict[str, str]] = {
    # What is accelerated at the joint besides the links: no element of URDF or SDF holds it.
    "armature": {
        MUJOCO: "joint/@armature",
        ISAACLAB: "ActuatorBaseCfg.armature",
        DRAKE: "actuator/drake:rotor_inertia/@value, with a gear ratio of 1",
    },
    "inertia": {
        MUJOCO: "body/inertial/@mass",
        ISAACLAB: "MassPropertiesCfg.mass",
        SDF: "link/inertial/mass",
        URDF: "link/inertial/mass/@value",
        DRAKE: "link/inertial/mass/@value",
    },
    "coulomb": {
        MUJOCO: "joint/@frictionloss",
        ISAACLAB: "ActuatorBaseCfg.dynamic_friction",
        SDF: "joint/axis/dynamics/friction",
        URDF: "joint/dynamics/@friction",
    },
    "viscous": DAMPING,
    "spring.stiffness": {
        MUJOCO: "joint/@stiffness",
        SDF: "joint/axis/dynamics/spring_stiffness",
    },
}
"""Fields of simulators by number of the law, or by EFFECT.PARAMETER.

References
----------
MuJoCo XML reference, joint; Isaac Lab, ``ActuatorBaseCfg`` (2.2); SDFormat 1.11, axis dynamics;
URDF, joint; Drake, parsing of URDF. Drake has no Coulomb friction of a joint.
"""


def numbers_to_enter(
    model: LinearModel,
    law: Mapping[str, LawNumber],
    posterior: Posterior,
    causes: Sequence[Cause],
    gap: Gap,
) -> tuple[tuple[Enter, ...], str | None]:
    """Return the numbers to enter, from the refit with the causes; else why there are none.

    Parameters
    ----------
    model : LinearModel
        In which the hypotheses were compared.
    law : mapping of str to LawNumber
        Of the law, with and without what acts beside it.
    posterior : Posterior
        Draws.
    causes : sequence of Cause
        Effects that are named.
    gap : Gap
        For the size of friction.
    """
    if model.data.rigs[0].has_pulleys:
        return (), OF_PULLEYS
    if not {"inertia", "armature", "coulomb"} & set(law):
        return (), NO_JOINT
    turns, has = model.data.unit == rotary_unit("N"), model.data.rigs[0].in_simulator
    found = [
        Enter(
            parameter=name,
            unit=number.unit,
            in_your_simulator=has.get(name),
            value=number.after,
            fields=_fields("armature" if turns and name == "inertia" else name),
            lost_without_why=HAS_FIELD,
        )
        for name, number in law.items()
    ]
    for cause in causes:
        damping = _damping(model, posterior) if cause.effect == "viscous" else None
        if damping is not None:
            unit = rotary_unit("N s/m") if turns else "N s/m"
            found.append(
                Enter(
                    parameter="viscous",
                    unit=unit,
                    in_your_simulator=has.get("viscous"),
                    value=interval(damping),
                    fields=_fields("viscous"),
                    lost_without_why=HAS_FIELD,
                )
            )
            continue
        found += _of_effect(cause, gap)
    return tuple(found), None


def _fields(name: str) -> dict[str, SimulatorField | None]:
    own = FIELDS.get(name, {})
    return {
        simulator: SimulatorField(field=own[simulator], factor=1.0) if simulator in own else None
        for simulator in SIMULATORS
    }


def _of_effect(cause: Cause, gap: Gap) -> list[Enter]:
    """Return the parameters of an effect; what is lost without is the rms of its force."""
    found = []
    for name, number in cause.parameters.items():
        fields = _fields(f"{cause.effect}.{name}")
        lost = cause.strength * gap.friction_rms if cause.strength > 0 else None
        somewhere = any(fields.values())
        found.append(
            Enter(
                parameter=f"{cause.effect}.{name}",
                unit=number.unit,
                value=number,
                fields=fields,
                lost_without=None if somewhere else lost,
                lost_without_why=HAS_FIELD if somewhere else NO_FORCE if lost is None else None,
            )
        )
    return found


def _damping(model: LinearModel, posterior: Posterior) -> Array | None:
    """Return draws of the damping of a joint, where its friction grows as Coulomb's share.

    The amplitude is a share of the Coulomb friction of the law that the model is around.
    """
    slope, coulomb = posterior.amplitudes.get("viscous"), _coulomb(model)
    variants = {law.law for law in model.lawbook.get("viscous", ())}
    if slope is None or coulomb is None or not variants <= {"constant", "friction"}:
        return None
    return np.asarray(slope * coulomb)


def _coulomb(model: LinearModel) -> float | None:
    if len(model.layout.sizes) > 1:
        return None  # a bench beside an axis: the share is of the friction of both
    (size,) = model.layout.sizes
    names = [name for name, _ in model.data.law_numbers(size)]
    if "coulomb" not in names:
        return None
    return float(np.asarray(model.laws[size][names.index("coulomb")]))

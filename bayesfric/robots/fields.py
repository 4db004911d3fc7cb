"""Where a number of a joint goes in each simulator: the field, and the factor to its unit.

References
----------
MuJoCo, XML reference (joint, actuator; damping as a polynomial and delays since 3.5, tried in
4.0); Isaac Lab, ``ActuatorBaseCfg`` (friction is a force or torque since Isaac Sim 5.0);
Omni Physics, ``PhysxJointAxisAPI`` (the parser multiplies viscousFrictionCoefficient of a turning
axis by 180/π); Newton, USD schema ``NewtonJointAPI`` (angles in degrees); Genesis,
``RigidEntity``; Drake, parsing of URDF (no Coulomb friction of a joint); SDFormat 1.12, joint
axis; URDF, joint.
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

MUJOCO, ISAACLAB, USD, NEWTON, GENESIS, DRAKE, SDF, URDF = SIMULATORS = (
    "mujoco",
    "isaaclab",
    "usd",
    "newton",
    "genesis",
    "drake",
    "sdf",
    "urdf",
)
"""As the keys of ``enter[].fields`` name them; ``usd`` is a stage for PhysX."""

LOAD_FRICTION = "load_friction"
"""Name of the callback for friction that grows with load, which none has a field for."""
PER_DEGREE = math.pi / 180

_COULOMB = {
    MUJOCO: "joint/@frictionloss",
    ISAACLAB: "ActuatorBaseCfg.friction and .dynamic_friction",
    USD: "physxJointAxis:{axis}:staticFrictionEffort and :dynamicFrictionEffort",
    NEWTON: "newton:friction",
    GENESIS: "RigidEntity.set_dofs_frictionloss",
    SDF: "joint/axis/dynamics/friction",
    URDF: "joint/dynamics/@friction",
}
_DAMPING = {
    MUJOCO: "joint/@damping",
    ISAACLAB: "ActuatorBaseCfg.viscous_friction",
    USD: "physxJointAxis:{axis}:viscousFrictionCoefficient",
    NEWTON: "newton:damping",
    GENESIS: "RigidEntity.set_dofs_damping",
    DRAKE: "joint/dynamics/@damping",
    SDF: "joint/axis/dynamics/damping",
    URDF: "joint/dynamics/@damping",
}
_ARMATURE = {
    MUJOCO: "joint/@armature",
    ISAACLAB: "ActuatorBaseCfg.armature",
    USD: "physxJointAxis:{axis}:armature",
    NEWTON: "newton:armature",
    GENESIS: "RigidEntity.set_dofs_armature",
    DRAKE: "actuator/drake:rotor_inertia/@value, with a gear ratio of 1",
}
_MASS = {
    MUJOCO: "body/inertial/@mass",
    ISAACLAB: "MassPropertiesCfg.mass",
    USD: "physics:mass",
    NEWTON: "physics:mass",
    GENESIS: "RigidLink.set_mass",
    DRAKE: "link/inertial/mass/@value",
    SDF: "link/inertial/mass",
    URDF: "link/inertial/mass/@value",
}
_LIMIT = {
    MUJOCO: "joint/@actuatorfrcrange, from minus to plus the value",
    ISAACLAB: "ActuatorBaseCfg.effort_limit_sim",
    USD: "drive:{axis}:physics:maxForce",
    NEWTON: "drive:{axis}:physics:maxForce",
    GENESIS: "RigidEntity.set_dofs_force_range, from minus to plus the value",
    DRAKE: "joint/limit/@effort",
    SDF: "joint/axis/limit/effort",
    URDF: "joint/limit/@effort",
}
_FIELDS: Mapping[str, Mapping[str, str]] = {
    "coulomb": _COULOMB,
    "coulomb-missing.force": _COULOMB,
    "viscous": _DAMPING,
    "armature": _ARMATURE,
    "mass": _MASS,
    "air-drag.coefficient": {MUJOCO: "joint/@damping, its second number"},
    "cubic-drag.coefficient": {MUJOCO: "joint/@damping, its third number"},
    "spring.stiffness": {
        MUJOCO: "joint/@stiffness",
        GENESIS: "RigidEntity.set_dofs_stiffness",
        SDF: "joint/axis/dynamics/spring_stiffness",
    },
    "spring.rest": {MUJOCO: "joint/@springref", SDF: "joint/axis/dynamics/spring_reference"},
    "delay.time": {MUJOCO: "actuator/@delay, with @nsample of one more than the delay in steps"},
    "actuator-lag.time": {MUJOCO: 'actuator/general/@dynprm, with dyntype="filterexact"'},
    "torque-saturation.limit": _LIMIT,
    "cogging.force": {MUJOCO: "actuator/dcmotor/@cogging, its first number"},
}
_BY_DEGREE = {
    USD: {"viscous": PER_DEGREE},
    NEWTON: {"viscous": PER_DEGREE},
    MUJOCO: {"spring.rest": 1 / PER_DEGREE},
}
"""Factors to what these simulators count in degrees, or by the degree, where an axis turns."""
_UNLESS_RADIAN = {MUJOCO: {"spring.rest"}}
"""What they count in radians where a model says ``<compiler angle="radian"/>``."""


class JointField(NamedTuple):
    """A field of a simulator, and by what a number in SI units is multiplied before it goes in."""

    field: str
    factor: float


def fields_of(parameter: str, *, turns: bool) -> dict[str, JointField | None]:
    """Return the field of a number in each simulator; None where it has none.

    Parameters
    ----------
    parameter : str
        ``coulomb``, ``viscous``, ``inertia``, ``armature`` or ``mass`` of the law, or
        EFFECT.PARAMETER of an effect.
    turns : bool
        Whether the axis turns: its inertia is then an armature, else a mass.
    """
    if parameter in ("inertia", "mass", "armature"):
        parameter = "armature" if turns else "mass"
    own, axis = _FIELDS.get(parameter, {}), "angular" if turns else "linear"

    def factor(simulator: str) -> float:
        return _BY_DEGREE.get(simulator, {}).get(parameter, 1.0) if turns else 1.0

    def name(simulator: str) -> str:
        radian = turns and parameter in _UNLESS_RADIAN.get(simulator, ())
        remark = ', in degrees (with compiler/@angle="radian" in rad: factor 1)' if radian else ""
        return own[simulator].replace("{axis}", axis) + remark

    return {
        simulator: JointField(name(simulator), factor(simulator)) if simulator in own else None
        for simulator in SIMULATORS
    }

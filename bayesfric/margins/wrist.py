"""Joints that share motors: motor angles φ = C θ, so torques map by τ_joints = Cᵀ τ_motors.

Each motor has its own loop, and while one motor moves the others are held. With D = C⁻¹, motor m
then turns joint j by D_jm: it carries the inertia Σ_j D_jm² I_j, the load Σ_j D_jm τ_j, and the
friction Σ_j |D_jm| f_j of the joints. A joint's error is that of all motors, D times theirs, and a
torque on the joints turns them by D Dᵀ over a motor's stiffness. To move a joint by hand while the
others are held, all motors in its column of C give way.

The other motors are assumed to have the drive, cable, friction and gains of this one.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bayesfric.arrays import Array
from bayesfric.margins.assembly import Assembly
from bayesfric.margins.loop_file import Loop, RevoluteJoint
from bayesfric.margins.quantities import central

Floats = tuple[float, ...]


@dataclass(frozen=True)
class JointAtShaft:
    """A joint referred to the motor's shaft, arrays of shape (draws,); fields of `LoopAtShaft`."""

    joint_friction: Array  # N·m
    load_inertia: Array  # kg·m²
    load_viscous: Array  # N·m·s/rad
    load_torque: Array  # N·m
    net_load: Array  # N·m, the load that gravity compensation leaves
    peak_velocity: Array  # rad/s
    peak_acceleration: Array  # rad/s²


@dataclass(frozen=True)
class Wrist:
    """The coupled joints around one motor: arrays of shape (draws,), tuples with one entry a motor.

    Parameters
    ----------
    axis : int
        Number of the motor and its joint, from 0.
    own_row : tuple of float
        D_km, how far each motor turns this joint [rad/rad].
    own_column : tuple of float
        C_mk, how far this joint alone turns each motor [rad/rad].
    compliance : tuple of float
        (D Dᵀ)_kj, what a torque on each joint turns this one by, times a motor's stiffness.
    joint : JointAtShaft
        All joints referred to this motor, in their fastest motion together.
    load : tuple of ndarray
        Load of the joints at each motor [N·m].
    swing : ndarray
        Torque of the motor for inertia and viscous friction of the joints in that motion [N·m].
    joint_friction, joint_load, joint_net_load : tuple of ndarray
        Of each joint, at the joint [N·m].
    """

    axis: int
    own_row: Floats
    own_column: Floats
    compliance: Floats
    joint: JointAtShaft
    load: tuple[Array, ...]
    swing: Array
    joint_friction: tuple[Array, ...]
    joint_load: tuple[Array, ...]
    joint_net_load: tuple[Array, ...]

    def worst(self, of_motors: Sequence[Array]) -> Array:
        """Return the joint's largest error if motor errors have any sign, Σ_m |D_km| e_m [rad]."""
        return _weighted(np.abs(self.own_row), of_motors)

    def reversing(self, of_motors: Sequence[Array]) -> Array:
        """Return the joint's error from the motors that reverse when it alone reverses [rad]."""
        return np.abs(_weighted(np.array(self.own_row) * np.sign(self.own_column), of_motors))

    def by_hand(self, of_motors: Sequence[Array]) -> Array:
        """Return the torque at the joint at which all of its motors are driven back [N·m]."""
        return _weighted(np.abs(self.own_column), of_motors)

    def under_friction(self) -> Array:
        """Return the joint's turn by friction of all joints, over a motor's compliance [N·m]."""
        return _weighted(np.abs(self.compliance), self.joint_friction)

    def under(self, loads: Sequence[Array]) -> Array:
        """Return the joint's turn by loads on all joints, over a motor's compliance [N·m]."""
        return np.abs(_weighted(np.array(self.compliance), loads))


def _weighted(weights: Array, values: Sequence[Array]) -> Array:
    parts = [weight * value for weight, value in zip(weights, values, strict=True)]
    return np.asarray(np.sum(parts, axis=0))


def wrist_of(loop: Loop, given: Assembly) -> Wrist | None:
    """Return the coupled joints of a loop; None without a coupling.

    Parameters
    ----------
    loop : Loop
        The file.
    given : Assembly
        Its numbers, one value for each draw.
    """
    coupling, joint = loop.coupling, loop.joint
    if coupling is None or not isinstance(joint, RevoluteJoint):
        return None
    c = np.array(coupling.matrix_rad_per_rad)
    d, k = np.linalg.inv(c), coupling.axis - 1
    keys = [f"coupling.others.{place}" for place in range(len(coupling.others))]
    keys.insert(k, "joint")
    loads = [other_joint.load_n_m for other_joint in coupling.others]
    loads.insert(k, joint.load_n_m)

    def of_joints(name: str) -> list[Array]:
        return [given[f"{key}.{name}"] for key in keys]

    inertia, viscous = of_joints("inertia_kg_m2"), of_joints("viscous_n_m_s")
    friction, load = of_joints("friction_n_m"), of_joints("load_n_m")
    speed, pull = of_joints("peak_velocity_rad_s"), of_joints("peak_acceleration_rad_s2")
    expected = [central(load_of_joint) for load_of_joint in loads]
    share = given["controller.gravity_compensation"]
    net = tuple(
        load_of_joint - share * mean for load_of_joint, mean in zip(load, expected, strict=True)
    )
    asked = [
        inertia_of_joint * rise + drag * fast
        for inertia_of_joint, rise, drag, fast in zip(inertia, pull, viscous, speed, strict=True)
    ]
    turned = np.abs(d[:, k])
    load_at_motors = tuple(_weighted(d[:, motor], load) for motor in range(len(c)))
    return Wrist(
        axis=k,
        own_row=tuple(map(float, d[k])),
        own_column=tuple(map(float, c[:, k])),
        compliance=tuple(map(float, d[k] @ d.T)),
        joint=JointAtShaft(
            joint_friction=_weighted(turned, friction),
            load_inertia=_weighted(turned**2, inertia),
            load_viscous=_weighted(turned**2, viscous),
            load_torque=load_at_motors[k],
            net_load=_weighted(d[:, k], net),
            peak_velocity=_weighted(np.abs(c[k]), speed),
            peak_acceleration=_weighted(np.abs(c[k]), pull),
        ),
        load=load_at_motors,
        swing=_weighted(turned, asked),
        joint_friction=tuple(friction),
        joint_load=tuple(load),
        joint_net_load=net,
    )

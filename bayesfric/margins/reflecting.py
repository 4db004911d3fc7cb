"""A loop file and its numbers, referred to the motor's shaft."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from bayesfric.arrays import Array
from bayesfric.margins.assembly import Assembly
from bayesfric.margins.cable_stage import Stage, in_series, lost_motion, stages_of
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.loop_file import Loop, RevoluteJoint
from bayesfric.margins.quantities import central
from bayesfric.margins.wrist import JointAtShaft, Wrist, wrist_of


def at_shaft(loop: Loop, given: Assembly, estimate: float | None = None) -> LoopAtShaft:
    """Refer a loop to the motor's shaft.

    Parameters
    ----------
    loop : Loop
        The file.
    given : Assembly
        Its numbers and the friction law, one value for each draw.
    estimate : float or None
        F̂ if the file has none; default: the mean friction of these draws [N·m].

    Returns
    -------
    LoopAtShaft
        With the same number of draws.
    """
    revolute = loop.joint.kind == "revolute"
    ratio = given[f"joint.transmission_rad_per_{'rad' if revolute else 'm'}"]
    rho = given["drive.capstan_radius_m"] / given["drive.gearbox_ratio"]
    wrist = wrist_of(loop, given)
    joint = _reflected_joint(loop, given, ratio) if wrist is None else wrist.joint
    motor_inertia = given["drive.inertia_kg_m2"]
    reduced = joint.load_inertia * motor_inertia / (joint.load_inertia + motor_inertia)
    stages = stages_of(loop, given, reduced)
    shaft_inertia, shaft_friction = _between_two_cables(loop, given, rho)
    drive = given["drive.friction_n_m"]
    friction = sum(stage.friction for stage in stages) + drive + joint.joint_friction
    friction = friction + shaft_friction
    stiffness = in_series([stage.stiffness for stage in stages])
    damping = sum(stage.damping * (stiffness / stage.stiffness) ** 2 for stage in stages)
    stiction = np.maximum(given["stiction_ratio"], 1.0)
    kp = _to_shaft(loop, given, ratio) * given["controller.kp_n_m_per_rad"]
    return LoopAtShaft(
        loop=loop,
        motor_inertia=motor_inertia,
        motor_viscous=given["drive.viscous_n_m_s"],
        stiffness=stiffness,
        damping=np.asarray(damping),
        friction=friction,
        drive_friction=drive,
        shaft_friction=shaft_friction,
        shaft_inertia=shaft_inertia,
        stiction_ratio=stiction,
        falling=np.zeros(given.draws),
        falling_speed=np.ones(given.draws),
        **vars(joint),
        efficiency=_efficiency(loop, stages, given.draws),
        cable_per_rad=rho,
        tip_per_rad=_tip_per_rad(loop, given, ratio, wrist),
        lost_motion=lost_motion(stages, shaft_friction, joint.joint_friction),
        backlash=given["drive.backlash_rad"],
        kick=given["kick.over_stuck_band"] * stiction * friction / kp,
        reference_speed=given["kick.reference_speed_rad_s"],
        stages=stages,
        wrist=wrist,
        **_controller(loop, given, ratio),
        **_limits(given),
        **_compensation(loop, given, float(friction.mean()) if estimate is None else estimate),
    )


def _reflected_joint(loop: Loop, given: Assembly, ratio: Array) -> JointAtShaft:
    """Refer a joint that has a motor of its own to the motor's shaft."""
    # Sections of revolute and prismatic joints have their keys in the same order.
    own = [f"joint.{key}" for key in type(loop.joint).model_fields if key != "kind"]
    inertia, friction, viscous, load, _, speed, pull = (given[key] for key in own)
    compensated = given["controller.gravity_compensation"] * _expected_load(loop)
    return JointAtShaft(
        joint_friction=friction / ratio,
        load_inertia=inertia / ratio**2,
        load_viscous=viscous / ratio**2,
        load_torque=load / ratio,
        net_load=(load - compensated) / ratio,
        peak_velocity=speed * ratio,
        peak_acceleration=pull * ratio,
    )


def _efficiency(loop: Loop, stages: Sequence[Stage], draws: int) -> Array:
    """Return the share of a force that the first cable transmits; all in a pair under tension.

    [-], of shape (draws,).
    """
    if loop.runs[0].topology == "antagonist-pair":
        return np.ones(draws)
    return np.asarray(np.prod([run.efficiency for run in stages[0].runs], axis=0))


def _tip_per_rad(loop: Loop, given: Assembly, ratio: Array, wrist: Wrist | None) -> Array:
    """Return the travel of the tip per angle of the motor [m/rad]."""
    if wrist is not None:
        return np.asarray(given["tool.lever_m"] * abs(wrist.own_row[wrist.axis]))
    return (given["tool.lever_m"] if loop.joint.kind == "revolute" else 1.0) / ratio


def _between_two_cables(loop: Loop, given: Assembly, rho: Array) -> tuple[Array, Array]:
    """Return inertia and friction of a shaft between two cables [kg·m², N·m]; 0 without."""
    if loop.second_stage is None:
        return np.zeros(given.draws), np.zeros(given.draws)
    turns = given["second_stage.driven_radius_m"] / rho  # turns of the motor for one of the shaft
    inertia = given["second_stage.shaft_inertia_kg_m2"] / turns**2
    return inertia, given["second_stage.shaft_friction_n_m"] / turns


def _controller(loop: Loop, given: Assembly, ratio: Array) -> dict[str, Any]:
    """Return the fields of a loop that describe its controller."""
    to_shaft = _to_shaft(loop, given, ratio)
    endless = np.full(given.draws, np.inf)
    velocity, position = (
        given.numbers.get(f"controller.{of}_cutoff_hz", endless) for of in ("velocity", "position")
    )
    counts = given["controller.encoder_counts_per_revolution"]
    return {
        "kp": to_shaft * given["controller.kp_n_m_per_rad"],
        "kd": to_shaft * given["controller.kd_n_m_s_per_rad"],
        "ki": to_shaft * given["controller.ki_n_m_per_rad_s"],
        "sample_time": given["controller.sample_time_s"],
        "delay": given["controller.delay_s"],
        "velocity_cutoff": 2 * np.pi * velocity,
        "position_cutoff": 2 * np.pi * position,
        "counts": counts / (ratio if loop.controller.encoder_at == "joint" else 1.0),
    }


def _limits(given: Assembly) -> dict[str, Any]:
    """Return the fields of a loop that limit its torque [N·m]."""
    constant = given["drive.torque_constant_n_m_per_a"]
    continuous = given.numbers.get("drive.continuous_current_a")
    return {
        "clip": constant * given["drive.current_limit_a"],
        "continuous": None if continuous is None else constant * continuous,
    }


def _compensation(loop: Loop, given: Assembly, mean_friction: float) -> dict[str, Array]:
    """Return the fields of a loop that compensate for friction."""
    estimate = given.numbers.get("compensation.estimate_n_m")
    if estimate is None:
        estimate = np.full(given.draws, mean_friction)
    unit = "rad" if loop.compensation.signal == "error" else "rad_s"
    return {
        "estimate": estimate,
        "gamma": given["compensation.gain"],
        "boundary": given[f"compensation.boundary_{unit}"],
    }


def _expected_load(loop: Loop) -> float:
    """Return the load for which gravity compensation is designed [N·m or N]."""
    joint = loop.joint
    return central(joint.load_n_m if isinstance(joint, RevoluteJoint) else joint.load_n)


def _to_shaft(loop: Loop, given: Assembly, ratio: Array) -> Array:
    """Return the factor that takes a gain from the file's frames to the motor's shaft."""
    gear = given["drive.gearbox_ratio"]
    per = {"motor": np.ones_like(gear), "gearbox-output": gear, "joint": ratio}
    return 1 / (per[loop.controller.torque_at] * per[loop.controller.angle_of])

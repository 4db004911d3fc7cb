"""A loop file and its numbers, reflected to the motor's shaft."""

import numpy as np

from bayesfric.arrays import Array
from bayesfric.margins.assembly import Assembly
from bayesfric.margins.cable_stage import in_series, lost_motion, stages_of
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.loop_file import Loop, RevoluteJoint
from bayesfric.margins.quantities import central
from bayesfric.margins.wrist import wrist_of

__all__ = ["at_shaft"]


def at_shaft(loop: Loop, given: Assembly, estimate: float | None = None) -> LoopAtShaft:
    """Reflect a loop to the motor's shaft.

    Parameters
    ----------
    loop : Loop
        The file.
    given : Assembly
        Its numbers and the friction law, a value a draw.
    estimate : float or None
        F̂ where the file has none; by default the mean friction of these draws [N·m].

    Returns
    -------
    LoopAtShaft
        Of as many draws.
    """
    revolute = loop.joint.kind == "revolute"
    ratio = given["joint.transmission_rad_per_rad" if revolute else "joint.transmission_rad_per_m"]
    gear = given["drive.gearbox_ratio"]
    rho = given["drive.capstan_radius_m"] / gear
    drive = given["drive.friction_n_m"]
    wrist = wrist_of(loop, given)
    own = given[f"joint.{'friction_n_m' if revolute else 'friction_n'}"] / ratio
    stiction = np.maximum(given["stiction_ratio"], 1.0)
    pair = loop.runs[0].topology == "antagonist-pair"
    load_inertia = given["joint.inertia_kg_m2" if revolute else "joint.mass_kg"] / ratio**2
    if wrist is not None:
        own, load_inertia = wrist.friction, wrist.inertia
    motor_inertia = given["drive.inertia_kg_m2"]
    reduced = load_inertia * motor_inertia / (load_inertia + motor_inertia)
    stages = stages_of(loop, given, reduced)
    shaft_inertia, shaft_friction = np.zeros((2, given.draws))
    if loop.second_stage is not None:
        turns = given["second_stage.driven_radius_m"] / rho  # of the motor, one of the shaft
        shaft_inertia = given["second_stage.shaft_inertia_kg_m2"] / turns**2
        shaft_friction = given["second_stage.shaft_friction_n_m"] / turns
    friction = sum(stage.friction for stage in stages) + drive + own + shaft_friction
    stiffness = in_series([stage.stiffness for stage in stages])
    to_shaft = _to_shaft(loop, gear, ratio)
    signal = loop.compensation.signal
    joint = {
        name: given[f"joint.{key[0] if revolute else key[1]}"]
        for name, key in {
            "viscous": ("viscous_n_m_s", "viscous_n_s_per_m"),
            "load": ("load_n_m", "load_n"),
            "velocity": ("peak_velocity_rad_s", "peak_velocity_m_s"),
            "acceleration": ("peak_acceleration_rad_s2", "peak_acceleration_m_s2"),
        }.items()
    }
    share = given["controller.gravity_compensation"]
    seen = {
        "load_viscous": joint["viscous"] / ratio**2,
        "load_torque": joint["load"] / ratio,
        "net_load": (joint["load"] - share * _expected_load(loop)) / ratio,
        "peak_velocity": joint["velocity"] * ratio,
        "peak_acceleration": joint["acceleration"] * ratio,
    }
    if wrist is not None:
        seen = {
            "load_viscous": wrist.viscous,
            "load_torque": wrist.load[wrist.axis],
            "net_load": wrist.net_load,
            "peak_velocity": wrist.peak_velocity,
            "peak_acceleration": wrist.peak_acceleration,
        }
    constant = given["drive.torque_constant_n_m_per_a"]
    continuous = given.numbers.get("drive.continuous_current_a")
    corners = (given.numbers.get(f"controller.{of}_cutoff_hz") for of in ("velocity", "position"))
    cutoff, position_cutoff = (None if corner is None else 2 * np.pi * corner for corner in corners)
    guess = given.numbers.get("compensation.estimate_n_m")
    if guess is None:
        guess = np.full(given.draws, float(friction.mean()) if estimate is None else estimate)
    return LoopAtShaft(
        loop=loop,
        motor_inertia=motor_inertia,
        load_inertia=load_inertia,
        motor_viscous=given["drive.viscous_n_m_s"],
        stiffness=stiffness,
        damping=np.asarray(
            sum(stage.damping * (stiffness / stage.stiffness) ** 2 for stage in stages)
        ),
        friction=friction,
        drive_friction=drive,
        shaft_friction=shaft_friction,
        joint_friction=own,
        shaft_inertia=shaft_inertia,
        stiction_ratio=stiction,
        falling=np.zeros(given.draws),
        falling_speed=np.ones(given.draws),
        kp=to_shaft * given["controller.kp_n_m_per_rad"],
        kd=to_shaft * given["controller.kd_n_m_s_per_rad"],
        ki=to_shaft * given["controller.ki_n_m_per_rad_s"],
        sample_time=given["controller.sample_time_s"],
        delay=given["controller.delay_s"],
        cutoff=cutoff,
        position_cutoff=position_cutoff,
        counts=given["controller.encoder_counts_per_revolution"]
        / (ratio if loop.controller.encoder_at == "joint" else 1.0),
        clip=constant * given["drive.current_limit_a"],
        continuous=None if continuous is None else constant * continuous,
        estimate=guess,
        gamma=given["compensation.gain"],
        boundary=given[f"compensation.boundary_{'rad' if signal == 'error' else 'rad_s'}"],
        efficiency=np.ones(given.draws)
        if pair
        else np.prod([run.efficiency for run in stages[0].runs], axis=0),
        cable_per_rad=rho,
        tip_per_rad=(given["tool.lever_m"] if revolute else 1.0) / ratio
        if wrist is None
        else given["tool.lever_m"] * abs(wrist.own_row[wrist.axis]),
        lost_motion=lost_motion(stages, shaft_friction, own),
        backlash=given["drive.backlash_rad"],
        kick=given["kick.over_stuck_band"]
        * stiction
        * friction
        / (to_shaft * given["controller.kp_n_m_per_rad"]),
        reference_speed=given["kick.reference_speed_rad_s"],
        stages=stages,
        wrist=wrist,
        **seen,
    )


def _expected_load(loop: Loop) -> float:
    """Return the load that gravity compensation is made for [N·m or N]."""
    joint = loop.joint
    return central(joint.load_n_m if isinstance(joint, RevoluteJoint) else joint.load_n)


def _to_shaft(loop: Loop, gear: Array, ratio: Array) -> Array:
    """Return what turns a gain of the file's frames into one at the motor's shaft."""
    per = {"motor": np.ones_like(gear), "gearbox-output": gear, "joint": ratio}
    return 1 / (per[loop.controller.torque_at] * per[loop.controller.angle_of])

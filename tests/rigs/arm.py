"""An arm of three joints that MuJoCo moves: turn at the base, shoulder and elbow in a plane."""

from dataclasses import dataclass
from functools import cache

import numpy as np
import pandas as pd

from bayesfric.recording.tables import Axis, Recording, RigConstants, Robot
from bayesfric.robots import RigidBodies, robot_of_bytes

JOINTS = ("base", "shoulder", "elbow")
FRICTIONLOSS, DAMPING, ARMATURE = (0.8, 1.5, 0.6), (0.5, 0.9, 0.3), (0.06, 0.09, 0.03)
MASSES = (3.0, 2.0, 1.2)
STIFF, DAMPED = np.array([400.0, 400.0, 150.0]), np.array([30.0, 30.0, 10.0])
STIFF_FRICTION = {"solreffriction": "0.0006 1", "solimpfriction": "0.99 0.999 0.001"}
"""MuJoCo's friction gives way a little where a joint turns; as stiff as this it does not."""
STEP_S, RATE_HZ, COUNT = 2.5e-4, 500, 2e-5


def model(masses, step_s=STEP_S, joints=({}, {}, {})):
    """Return MJCF of the arm; a radian is a radian."""
    of = [" ".join(f'{key}="{value}"' for key, value in joint.items()) for joint in joints]
    return f"""<mujoco><compiler angle="radian"/><option timestep="{step_s}"
 integrator="implicitfast"/><worldbody><body name="column">
 <joint name="j1" axis="0 0 1" {of[0]}/><geom type="box" size=".05 .05 .1" mass="{masses[0]}"/>
 <body name="upper" pos="0 0 .1"><joint name="j2" axis="0 1 0" {of[1]}/>
  <geom type="capsule" fromto="0 0 0 .3 0 0" size=".03" mass="{masses[1]}"/>
  <body name="lower" pos=".3 0 0"><joint name="j3" axis="0 1 0" {of[2]}/>
   <geom type="capsule" fromto="0 0 0 .25 0 0" size=".025" mass="{masses[2]}"/>
</body></body></body></worldbody></mujoco>"""


@dataclass(frozen=True)
class Reference:
    """A sum of sines for each joint, from rest at zero."""

    rate: np.ndarray
    size: np.ndarray
    phase: np.ndarray

    def at(self, t):
        turned = self.rate * t + self.phase
        place = (self.size * (np.sin(turned) - np.sin(self.phase))).sum(axis=1)
        return place, (self.size * self.rate * np.cos(turned)).sum(axis=1)


@cache
def log_of_arm(seed=1, seconds=15.0):
    """Return times, counted positions and commanded torques of the moving arm."""
    import mujoco

    rng = np.random.default_rng(seed)
    settings = zip(FRICTIONLOSS, DAMPING, ARMATURE, strict=True)
    names = ("frictionloss", "damping", "armature")
    joints = [
        dict(zip(names, joint_settings, strict=True)) | STIFF_FRICTION
        for joint_settings in settings
    ]
    compiled = mujoco.MjModel.from_xml_string(model(MASSES, joints=joints))
    data = mujoco.MjData(compiled)
    reference = Reference(
        2 * np.pi * rng.uniform(0.15, 0.9, (3, 4)),
        rng.uniform(0.1, 0.35, (3, 4)),
        rng.uniform(0.0, 2 * np.pi, (3, 4)),
    )
    data.qvel[:] = reference.at(0.0)[1]
    samples, before = [], None
    for k in range(int(seconds * RATE_HZ)):
        place, rate = reference.at(k / RATE_HZ)
        read = np.round(data.qpos / COUNT) * COUNT
        speed = rate if before is None else (read - before) * RATE_HZ
        before = read
        torque = STIFF * (place - read) + DAMPED * (rate - speed)
        samples.append([k / RATE_HZ, *read, *torque])
        data.qfrc_applied[:] = torque
        for _ in range(round(1 / RATE_HZ / STEP_S)):
            mujoco.mj_step(compiled, data)
    return np.array(samples)


def robot(masses=MASSES, joints=({}, {}, {})):
    """Return the user's model of the arm."""
    names = dict(zip(JOINTS, ("j1", "j2", "j3"), strict=True))
    return Robot("arm.xml", names, model(masses, joints=joints).encode())


def recording(seed=1, *, model_of=None, known=False, only=None, **rig):
    """Return a log of all joints, or of one; with a model of the arm, or what it says."""
    log = log_of_arm(seed)
    place, torque = log[:, 1:4], log[:, 4:7]
    parts = []
    for j, name in enumerate(JOINTS):
        if only not in (None, name):
            continue
        part = pd.DataFrame(
            {"run": "a", "joint": name, "time_s": log[:, 0], "position_m": place[:, j]}
        ).assign(force_n=torque[:, j])
        if known:
            part["known_force_n"] = torque_of_model()[:, j]
        parts.append(part)
    constants = RigConstants(rotary=True, force_is="commanded", robot=model_of, **rig)
    runs = pd.DataFrame({"run": ["a"]})
    return Recording("arm", "An arm", constants, axis=Axis(runs, pd.concat(parts)))


def torque_of_model(seed=1):
    """Return dp/dt − r along the path, by splines of what was read."""
    from scipy.signal import savgol_filter

    log = log_of_arm(seed)
    place, rate = (
        savgol_filter(log[:, 1:4], 21, 3, deriv=d, delta=1 / RATE_HZ, axis=0) for d in (0, 1)
    )
    own = robot()
    bodies = RigidBodies(robot_of_bytes(own.model, own.content, own.joints))
    momentum, pull = bodies.momentum_and_pull(place, rate)
    return savgol_filter(momentum, 21, 3, deriv=1, delta=1 / RATE_HZ, axis=0) - pull

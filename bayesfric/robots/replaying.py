"""A robot's recorded motion again in MuJoCo, with values of its joints: torques and trajectories.

Torques are those that the model asks for along the motion as it was recorded (inverse dynamics).
Trajectories begin at recorded states and are driven by the recorded forces for a short while: over
a long one a simulated joint is soon somewhere else, whatever its friction.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bayesfric.arrays import Array
from bayesfric.robots.model_file import JointSettings, Robot

STEP_S = 1e-3  # of the simulation, at the most
LOCKED = 1e9  # armature of joints that nobody logged: they stay where they are


@dataclass(frozen=True)
class Motion:
    """A run of all logged joints, evenly sampled.

    Parameters
    ----------
    interval_s : float
        Between samples [s].
    position, velocity, acceleration : ndarray, shape (N, J)
        Smoothed.
    force : ndarray, shape (N, J)
        That drove each joint.
    """

    interval_s: float
    position: Array
    velocity: Array
    acceleration: Array
    force: Array

    def some(self, rows: slice) -> "Motion":
        """Return some of the samples, with the interval as it was."""
        parts = (self.position, self.velocity, self.acceleration, self.force)
        return Motion(self.interval_s, *(values[rows] for values in parts))


def inverse_torques(robot: Robot, joints: Sequence[JointSettings], motion: Motion) -> Array:
    """Return the drive force that the model asks for along a motion, shape (N, J).

    Parameters
    ----------
    robot : Robot
        Its joints are set, and set back afterwards.
    joints : sequence of JointSettings
        J values.
    motion : Motion
        N samples.
    """
    import mujoco

    model, dofs, places = _set(robot, joints, motion)
    data = mujoco.MjData(model)
    torques = np.empty_like(motion.force)
    for k in range(len(torques)):
        data.qpos[places], data.qvel[dofs] = motion.position[k], motion.velocity[k]
        data.qacc[:] = 0.0
        data.qacc[dofs] = motion.acceleration[k]
        mujoco.mj_inverse(model, data)
        torques[k] = data.qfrc_inverse[dofs]
    return torques


def replayed(
    robot: Robot,
    joints: Sequence[JointSettings],
    motion: Motion,
    starts: Sequence[int],
    samples: int,
) -> Array:
    """Return where the joints go from recorded states on, shape (windows, samples, J).

    Parameters
    ----------
    robot : Robot
        As of :func:`inverse_torques`.
    joints : sequence of JointSettings
        J values.
    motion : Motion
        Where windows begin, and the forces that drive them.
    starts : sequence of int
        Samples at which windows begin.
    samples : int
        Of a window, the first among them.
    """
    import mujoco

    model, dofs, places = _set(robot, joints, motion)
    data = mujoco.MjData(model)
    steps = int(np.ceil(motion.interval_s / STEP_S))
    paths = np.empty((len(starts), samples, len(dofs)))
    for window, start in enumerate(starts):
        mujoco.mj_resetData(model, data)
        data.qpos[places], data.qvel[dofs] = motion.position[start], motion.velocity[start]
        for sample in range(samples):
            paths[window, sample] = data.qpos[places]
            now, after = motion.force[start + sample : start + sample + 2]
            for step in range(steps):
                data.qfrc_applied[dofs] = now + (after - now) * (step + 0.5) / steps
                mujoco.mj_step(model, data)
    return paths


def _set(robot: Robot, joints: Sequence[JointSettings], motion: Motion) -> tuple[Any, Any, Any]:
    """Return the model with the joints set, and where their speeds and positions are in it."""
    import mujoco

    model = robot.compiled
    logged = list(robot.places)
    dofs, places = model.jnt_dofadr[logged], model.jnt_qposadr[logged]
    model.dof_armature[:] = LOCKED
    for dof, place, at, joint in zip(dofs, logged, places, joints, strict=True):
        model.dof_armature[dof] = joint.armature
        model.dof_frictionloss[dof] = joint.frictionloss
        model.dof_damping[dof] = joint.damping[0]
        if hasattr(model, "dof_dampingpoly"):
            model.dof_dampingpoly[dof] = joint.damping[1:]
        model.jnt_stiffness[place] = joint.stiffness
        model.qpos_spring[at] = joint.spring_rest
    # A recorded motion takes place within the stops and touches nothing that the log tells.
    disabled = mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT
    model.opt.disableflags |= int(disabled)
    model.opt.timestep = motion.interval_s / np.ceil(motion.interval_s / STEP_S)
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return model, dofs, places

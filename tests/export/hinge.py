"""A pendulum that MuJoCo moves: friction, damping and armature of its hinge are known."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from bayesfric.recording.tables import Axis, Recording, RigConstants, Robot

STEP_S, RATE_HZ, COUNT = 5e-4, 250, 2e-5
STIFF, DAMPED = 150.0, 8.0
STIFF_FRICTION = 'solreffriction="0.0012 1" solimpfriction="0.99 0.999 0.001"'
"""MuJoCo's friction gives way a little where a joint turns; as stiff as this it does not."""


@dataclass(frozen=True)
class Hinge:
    """Numbers of the joint, in SI units; the link is a rod of 1.2 kg and 0.3 m."""

    frictionloss: float = 0.6
    damping: float = 0.3
    armature: float = 0.05
    rod: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """By which its mass [share], centre [m] and inertia about that [share] are not the usual."""

    def inertial(self):
        """Return the rod's numbers as MJCF has them; nothing of the usual one, by its shape."""
        if not any(self.rod):
            return ""
        heavier, shifted, rounder = self.rod
        slim, stout = (inertia * (1 + rounder) for inertia in (0.000236, 0.010816))
        return (
            f'<inertial pos="{0.15 + shifted} 0 0" mass="{1.2 * (1 + heavier)}"'
            f' diaginertia="{slim} {stout} {stout}"/>'
        )

    def model(self, further="", joint="hinge"):
        """Return MJCF with these numbers."""
        return f"""<mujoco model="one">
  <!-- a rod -->
  <compiler angle="radian"/>
  <option timestep="{STEP_S}" integrator="implicitfast"/>
  <worldbody>
    <body name="rod">
      <joint name="{joint}" axis="0 1 0" frictionloss="{self.frictionloss}" damping="{self.damping}"
             armature="{self.armature}" {further}/>
      {self.inertial()}
      <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.02" mass="1.2"/>
    </body>
  </worldbody>
</mujoco>
"""

    def urdf(self):
        """Return URDF of the same rod, without what URDF has no field for."""
        return f"""<robot name="one">
  <link name="base"/>
  <link name="rod"><inertial><origin xyz="0.15 0 0"/><mass value="1.2"/>
    <inertia ixx="0.001" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="hinge" type="continuous"><parent link="base"/><child link="rod"/>
    <axis xyz="0 1 0"/><dynamics damping="{self.damping}" friction="{self.frictionloss}"/></joint>
</robot>
"""


def drawn_hinge(seed):
    """Return a hinge with numbers of its own."""
    rng = np.random.default_rng(seed)
    return Hinge(rng.uniform(0.3, 1.2), rng.uniform(0.1, 0.7), rng.uniform(0.02, 0.12))


def log_of(hinge, seed=1, seconds=12.0):
    """Return times, counted positions and torques with the noise of a sensor."""
    import mujoco

    rng = np.random.default_rng(seed)
    compiled = mujoco.MjModel.from_xml_string(hinge.model(STIFF_FRICTION))
    data = mujoco.MjData(compiled)
    rate, size = 2 * np.pi * rng.uniform(0.2, 1.1, 4), rng.uniform(0.15, 0.4, 4)
    phase = rng.uniform(0, 2 * np.pi, 4)
    rows, before = [], None
    for k in range(int(seconds * RATE_HZ)):
        t = k / RATE_HZ
        place = float((size * (np.sin(rate * t + phase) - np.sin(phase))).sum())
        speed = float((size * rate * np.cos(rate * t + phase)).sum())
        if before is None:
            data.qvel[0] = speed
        read = float(np.round(data.qpos[0] / COUNT) * COUNT)
        moved = speed if before is None else (read - before) * RATE_HZ
        before = read
        torque = STIFF * (place - read) + DAMPED * (speed - moved)
        rows.append([t, read, torque + rng.normal(0, 0.01)])
        data.qfrc_applied[0] = torque
        for _ in range(round(1 / RATE_HZ / STEP_S)):
            mujoco.mj_step(compiled, data)
    return np.array(rows)


def recording(hinge, seed=1, *, own=None, seconds=12.0):
    """Return its log beside a user's model, which has other numbers; None is no model."""
    table = pd.DataFrame(log_of(hinge, seed, seconds), columns=["time_s", "position_m", "force_n"])
    robot = None
    if own is not None:
        robot = Robot("one.xml", {"swing": "hinge"}, own.model().encode())
    constants = RigConstants(
        rotary=True,
        force_is="commanded",
        other_joints="still",
        robot=robot,
        encoder_resolution=COUNT,
    )
    axis = Axis(pd.DataFrame({"run": ["a"]}), table.assign(run="a"))
    return Recording("hinge", "A simulated hinge", constants, axis=axis)

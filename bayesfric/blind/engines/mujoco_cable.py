"""One trial of the gravity board as MuJoCo runs it.

Two slide joints, coupled by an equality, carry the masses; a fixed tendon over both is the
cable, whose frictionloss is the friction of the trial.
"""

from dataclasses import dataclass

import numpy as np

from bayesfric.blind.engines.law import GRAVITY
from bayesfric.blind.engines.state import Array

MODEL = """
<mujoco>
  <option integrator="RK4" timestep="{step}" gravity="0 0 -{gravity}" density="{density}"/>
  <worldbody>
    <body>
      <joint name="drive" type="slide" axis="0 0 -1" armature="{armature}"/>
      <inertial pos="0 0 0" mass="{drive}" diaginertia="{drive_box} {drive_box} {drive_box}"/>
    </body>
    <body pos="1 0 0">
      <joint name="load" type="slide" axis="0 0 1" armature="{armature}"/>
      <inertial pos="0 0 0" mass="{load}" diaginertia="{load_box} {load_box} {load_box}"/>
    </body>
  </worldbody>
  <equality><joint joint1="drive" joint2="load" solref="{soft} 1"/></equality>
  <tendon>
    <fixed frictionloss="{friction}" damping="{damping}" stiffness="{stiffness}" springlength="0">
      <joint joint="drive" coef="0.5"/>
      <joint joint="load" coef="0.5"/>
    </fixed>
  </tendon>
</mujoco>
"""
STEP_S = 1e-3
HALF_BOX_M = 0.05  # of the body that a fluid sees


@dataclass(frozen=True)
class Cable:
    """Numbers of one trial.

    Parameters
    ----------
    drive_kg, load_kg : float
        Masses.
    friction_n : float
        Against the motion [N].
    damping, armature_kg, drag, stiffness : float
        Force per speed [N s/m], mass that moves along [kg], force per speed squared
        [N s²/m²] and per travel [N/m].
    applied_n : float
        Against the motion, as an applied force [N].
    soft_s : float
        Time constant of the equality.
    """

    drive_kg: float
    load_kg: float
    friction_n: float
    damping: float = 0.0
    armature_kg: float = 0.0
    drag: float = 0.0
    stiffness: float = 0.0
    applied_n: float = 0.0
    soft_s: float = 0.002


def closed_form(cable: Cable) -> float:
    """Return the acceleration of eq. (4) with the friction of a trial [m/s²]."""
    pull = (cable.drive_kg - cable.load_kg) * GRAVITY - cable.friction_n - cable.applied_n
    return pull / (cable.drive_kg + cable.load_kg + cable.armature_kg)


def moved(cable: Cable, seconds: float) -> tuple[Array, Array, Array]:
    """Return times, travel and speed of a trial that MuJoCo runs, the release first."""
    import mujoco
    from mujoco import rollout

    # Of a cube of half size r a fluid sees a drag of 2 ρ r² v² [MuJoCo, fluid model].
    box = [2 / 3 * mass * HALF_BOX_M**2 for mass in (cable.drive_kg, cable.load_kg)]
    model = mujoco.MjModel.from_xml_string(
        MODEL.format(
            step=STEP_S,
            gravity=GRAVITY,
            density=cable.drag / (4 * HALF_BOX_M**2),
            armature=cable.armature_kg / 2,
            drive=cable.drive_kg,
            load=cable.load_kg,
            drive_box=box[0],
            load_box=box[1],
            soft=cable.soft_s,
            friction=cable.friction_n,
            damping=cable.damping,
            stiffness=cable.stiffness,
        )
    )
    start = np.zeros((1, mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)))
    steps = int(np.ceil(seconds / STEP_S))
    applied = np.full((1, steps, 2), -cable.applied_n / 2)
    spec = int(mujoco.mjtState.mjSTATE_QFRC_APPLIED)
    states, _ = rollout.rollout(
        model, mujoco.MjData(model), start, applied, control_spec=spec, nstep=steps
    )
    time, drive, load, speed_drive, speed_load = states[0, :, :5].T

    def with_start(values: Array) -> Array:
        return np.concatenate([[0.0], values])

    return (
        with_start(time),
        with_start((drive + load) / 2),
        with_start((speed_drive + speed_load) / 2),
    )

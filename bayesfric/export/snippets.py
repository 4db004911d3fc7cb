"""Callbacks for numbers for which no simulator has a field."""

from collections.abc import Mapping

from bayesfric.export.digits import by_error
from bayesfric.export.joints import ExportedJoint

SHARE = "load-friction.share"
LOAD_FRICTION_FILE = "load_friction.py"
LOAD_FRICTION = '''"""Friction that grows with load, for MuJoCo: share times what a gear carries.

Call `install(model)` once after loading the model; `mujoco.set_mjcb_passive(None)` takes it off.
What a gear carries is the torque that the links ask for: weight, Coriolis and acceleration of the
last step, without the armature, which is on the motor's side.
"""

import mujoco
import numpy as np

SHARES = {shares}
STILL = 0.01  # rad/s or m/s, below which the friction goes to zero smoothly


def install(model):
    """Add the friction of all joints in SHARES to the passive forces of a model."""
    joints = {{name: model.joint(name) for name in SHARES}}
    dofs = np.array([int(joint.dofadr[0]) for joint in joints.values()])
    share = np.array([SHARES[name] for name in joints])
    carried = np.zeros(model.nv)

    def passive(model, data):
        mujoco.mj_rne(model, data, 1, carried)
        friction = share * np.abs(carried[dofs])
        data.qfrc_passive[dofs] -= friction * np.tanh(data.qvel[dofs] / STILL)

    mujoco.set_mjcb_passive(passive)
'''


def load_friction_text(joints: Mapping[str, ExportedJoint]) -> str | None:
    """Return the file of the callback; None if no joint has friction that grows with load.

    Parameters
    ----------
    joints : mapping of str to ExportedJoint
        Joints by name in the model.
    """
    shares = {
        place: joint.numbers[SHARE].value
        for place, joint in joints.items()
        if SHARE in joint.numbers
    }
    if not shares:
        return None
    lines = ", ".join(
        f"{name!r}: {by_error(value.mean, value.sd)}" for name, value in shares.items()
    )
    return LOAD_FRICTION.format(shares=f"{{{lines}}}")

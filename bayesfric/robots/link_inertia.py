"""What a model has about one of its joints: of its links, and set at the joint itself."""

from pathlib import Path

import numpy as np

from bayesfric.robots.dynamics import RigidBodies
from bayesfric.robots.model_file import JointSettings, read_robot


def link_inertia(path: Path, joint: str) -> float:
    """Return the inertia of the links about a joint, or their mass along it [kg·m² or kg].

    All joints of the model are at their reference positions.

    Parameters
    ----------
    path : Path
        The model, URDF or MJCF.
    joint : str
        Its name in the model.

    Raises
    ------
    InputError
        The model cannot be used.
    """
    robot = read_robot(path.parent, path.name, {joint: joint})
    reference = np.asarray(robot.compiled.qpos0)[robot.compiled.jnt_qposadr[list(robot.places)]]
    momentum, _ = RigidBodies(robot).momentum_and_pull(reference[None], np.ones((1, 1)))
    return float(momentum[0, 0])


def settings_of(path: Path, joint: str) -> JointSettings:
    """Return what a model has set at a joint, whether the joint says it or a class of defaults.

    Parameters
    ----------
    path : Path
        The model, URDF or MJCF.
    joint : str
        Its name in the model.

    Raises
    ------
    InputError
        The model cannot be used.
    """
    (settings,) = read_robot(path.parent, path.name, {joint: joint}).settings
    return settings

"""A robot's rigid-body model: what it says of the torque of each joint along a recorded motion.

:mod:`.model_file` reads a URDF or MJCF file, :mod:`.kinematics` lays its links along a motion,
:mod:`.dynamics` gives momentum and pull of each joint and how both depend on masses, and
:mod:`.model_errors` gives what errors of the model may add.
"""

from bayesfric.robots.dynamics import PARAMETERS, RigidBodies
from bayesfric.robots.model_errors import ModelErrors, model_error_columns, root_of_errors
from bayesfric.robots.model_file import JointSettings, Robot, read_robot, robot_of_bytes

__all__ = [
    "PARAMETERS",
    "JointSettings",
    "ModelErrors",
    "RigidBodies",
    "Robot",
    "model_error_columns",
    "read_robot",
    "robot_of_bytes",
    "root_of_errors",
]

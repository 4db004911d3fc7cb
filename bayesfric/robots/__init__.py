"""A robot's rigid-body model: what it says of the torque of each joint along a recorded motion.

:mod:`.model_file` reads a URDF or MJCF file, :mod:`.dynamics` lays its links along a motion and
gives momentum and pull of each joint and how both depend on masses, and :mod:`.model_errors` gives
what errors of the model may add.
"""

from bayesfric.robots.dynamics import PARAMETERS as PARAMETERS
from bayesfric.robots.dynamics import RigidBodies as RigidBodies
from bayesfric.robots.model_errors import root_of_errors as root_of_errors
from bayesfric.robots.model_file import JointSettings as JointSettings
from bayesfric.robots.model_file import Robot as Robot
from bayesfric.robots.model_file import read_robot as read_robot
from bayesfric.robots.model_file import robot_of_bytes as robot_of_bytes

"""What errors of a robot's model may add to the torque of its joints.

A link's mass, centre of mass and inertia are known to some 15 %, 2 cm and 30 %. Many of their
combinations move no logged joint, and others move all alike: what counts are the base
parameters, which whoever has rows of torque finds as the leading directions of what amounts of
N(0, 1) add to them.

References
----------
M. Gautier, W. Khalil, "Direct calculation of minimum set of inertial parameters of serial
robots", IEEE Trans. Robotics and Automation 6 (1990).
"""

import numpy as np

from bayesfric.arrays import Array
from bayesfric.robots.dynamics import PARAMETERS, RigidBodies, six_moments

# How well a model is known, as prior standard deviations: of each link's mass and of its moments of
# inertia about its centre of mass, relative; of each coordinate of that centre [m].
MASS_SD, INERTIA_SD, CENTRE_SD_M = 0.15, 0.3, 0.02


def root_of_errors(bodies: RigidBodies) -> Array:
    """Return how independent N(0, 1) amounts move the links' numbers, shape (10 × links,) twice.

    Parameters
    ----------
    bodies : RigidBodies
        The model.
    """
    count = len(PARAMETERS)
    root = np.zeros((count * len(bodies.links),) * 2)
    for link, numbers in enumerate(bodies.parameters):
        block = slice(link * count, (link + 1) * count)
        root[block, block] = _root_of_link(numbers)
    return root


def _root_of_link(numbers: Array) -> Array:
    """Return how ten independent N(0, 1) move a link's numbers, shape (10, 10)."""
    mass, moments = numbers[0], numbers[1:4]
    root = np.zeros((10, 10))
    if mass <= 0:
        return root
    centre = moments / mass
    about_origin = _steiner(centre)
    central = numbers[4:] - mass * about_origin
    # A larger mass: all numbers but the inertia about the centre grow with it.
    root[:, 0] = MASS_SD * mass * np.concatenate([[1.0], centre, about_origin])
    for axis in range(3):  # the centre moves: first moments, and inertia about the origin
        step = np.zeros(3)
        step[axis] = 1.0
        turned = 2 * centre @ step * np.eye(3) - np.outer(centre, step) - np.outer(step, centre)
        root[1:4, 1 + axis] = CENTRE_SD_M * mass * step
        root[4:, 1 + axis] = CENTRE_SD_M * mass * six_moments(turned)
    scale = INERTIA_SD * np.abs(central[:3]).max()
    root[4:, 4:] = scale * np.eye(6)
    return root


def _steiner(centre: Array) -> Array:
    return six_moments(centre @ centre * np.eye(3) - np.outer(centre, centre))

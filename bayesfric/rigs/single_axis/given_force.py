"""Runs whose force is given and whose motion follows: constant forces under which a joint spins up.

The windows explain the force by the motion. A force that is constant in each run is then explained
exactly by a friction that differs from run to run, without mass and viscous friction, and any
scatter of friction that is free enough imitates this.
"""

import numpy as np

from bayesfric.arrays import Array
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.readings import Readings, rough_law_of

NEARLY_NONE = (1e-5, 1e-4)
"""Range of a relative scatter of friction for a given force, which scatter could imitate."""


def force_is_given(readings: Readings) -> bool:
    """Return whether the force of each run is constant while the joint accelerates.

    The forces of inertia and friction then cancel each other's changes. In a control loop the force
    changes by at least the force of inertia.

    Parameters
    ----------
    readings : Readings
        Windows of all runs.
    """
    force = _spread(readings, readings.force)
    if not force < AXIS_RULES.one_force * float(np.mean(np.abs(readings.force))):
        return False
    mass = rough_law_of(readings, np.ones(readings.count, dtype=np.bool_)).mass
    return force < AXIS_RULES.given_force * mass * _spread(readings, readings.acceleration)


def relaxes(readings: Readings) -> bool:
    """Return whether the speed of each run relaxes to a final value, as under a constant force.

    The acceleration then falls in proportion to the speed: `m a = F - c - b v`.

    Parameters
    ----------
    readings : Readings
        Windows of all runs.
    """
    acceleration = _within(readings, readings.acceleration)
    speed = _within(readings, readings.mean_speed)
    along, square = float(acceleration @ speed), float(speed @ speed)
    explained2 = AXIS_RULES.relaxes * float(acceleration @ acceleration) * square
    return along < 0 and along**2 > explained2


def _within(readings: Readings, values: Array) -> Array:
    """Return deviations from the mean of each run and direction, (W,)."""
    ways = np.unique(np.column_stack([readings.trial, readings.way]), axis=0, return_inverse=True)
    group = ways[1].ravel()
    return np.asarray(values - (np.bincount(group, values) / np.bincount(group))[group])


def _spread(readings: Readings, values: Array) -> float:
    """Return the rms deviation from the mean of each run and direction."""
    return float(np.std(_within(readings, values)))

"""Logs whose force has nothing of the joint's friction: a relay along the speed, a hand.

A controller that feeds a free swing pushes with one size along the speed. Least squares then
explain all of the force by Coulomb friction, without inertia and without weight, and leave
nothing. A joint that a hand moves while its drive bears the weight alone has a force by the place
alone, as if it had neither inertia nor friction. Of both the fit is perfect, and wrong.
"""

from typing import NamedTuple

import numpy as np

from bayesfric.arrays import Flags
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.measures import Measures
from bayesfric.rigs.single_axis.readings import Readings, rough_law_of


class MovedOtherwise(NamedTuple):
    """Why the force of a log tells no number of the joint's law.

    Parameters
    ----------
    why : str
        In a few words.
    advice : str
        The same as a reader is told, with what to record.
    """

    why: str
    advice: str


RELAY = MovedOtherwise(
    "the force only follows the sign of the speed, as from a controller that feeds a swing",
    "The force has one size and only follows the sign of the speed. A controller that feeds a free "
    "swing makes such a force, and so would Coulomb friction alone. This log cannot separate them, "
    "so no number of the law is estimated. Record the joint as it follows a path",
)
BY_HAND = MovedOtherwise(
    "the force depends on the position only, and something outside the log moves the joint",
    "The force depends on the position only, without friction and without inertia. Such a drive "
    "bears a weight while a hand, or another joint, moves it. So no number of the law is "
    "estimated. Log the force of the hand, or let the drive move the joint",
)


def moved_otherwise(readings: Readings, measures: Measures, inside: Flags) -> MovedOtherwise | None:
    """Return why the force says nothing of friction; None where it may.

    Parameters
    ----------
    readings : Readings
        Rows of all runs.
    measures : Measures
        Of the axis.
    inside : ndarray of bool, shape (W,)
        Rows within the drive's limit.
    """
    force, rough = readings.force, rough_law_of(readings, inside)
    moved = rough.mass * measures.acceleration
    is_one_size = np.std(force) < AXIS_RULES.one_force * abs(float(np.mean(force)))
    if measures.rotary and is_one_size and readings.swings_alike:
        return RELAY if moved < AXIS_RULES.one_force * measures.force else None
    size = float(np.sqrt(np.mean((readings.drive @ readings.weights) ** 2)))
    friction = rough.coulomb + rough.viscous * measures.speed
    nothing = max(moved, friction) < AXIS_RULES.no_friction * size
    return BY_HAND if nothing else None

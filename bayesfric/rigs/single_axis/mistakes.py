"""Detects likely mistakes of units, signs or the experiment in the log of an axis.

The force of some logs does not show the joint's friction: that of a relay, of a hand, with a wrong
sign, or if one constant force spins the joint up.

A controller that sustains a free swing pushes with a constant force along the velocity. Least
squares then explain the whole force by Coulomb friction, without inertia and weight. If a hand
moves a joint whose drive only carries the weight, the force depends on position alone, as if there
were neither inertia nor friction. In both cases the fit is perfect, and wrong. With a wrong sign of
the force, friction, and often inertia, are estimated below 0, which is impossible.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bayesfric.arrays import Array, Flags
from bayesfric.inference.clustered import clustered_covariance
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.given_force import relaxes
from bayesfric.rigs.single_axis.measures import Measures
from bayesfric.rigs.single_axis.readings import Readings, rough_law_of
from bayesfric.rigs.single_axis.rough import pull_columns

EXACTLY = 1e-6  # largest relative difference between forces of one constant command
SURELY = 4.0  # least distance from 0 of an estimate that is certainly negative [standard errors]


class MovedOtherwise(NamedTuple):
    """Why the force of a log does not determine the joint's law.

    Parameters
    ----------
    why : str
        The reason in a few words.
    advice : str
        The reason for the reader, with advice on what to record.
    """

    why: str
    advice: str


RELAY = MovedOtherwise(
    "the force only follows the sign of the speed, as from a controller that feeds a swing",
    "The force has one size and only follows the sign of the speed. A controller that feeds a free "
    "swing makes such a force, and so would Coulomb friction alone. This log cannot separate them, "
    "so no number of the law is estimated. Record the joint as it follows a path",
)
ONE_LEVEL = MovedOtherwise(
    "the force has one size while the joint spins up, which shows only ratios of the law's numbers",
    "The force has one size throughout, and the joint spins up to a final speed. This motion shows "
    "the ratio of viscous friction to inertia, and of the force that is left to inertia, but not "
    "the three numbers. So no number of the law is estimated. Repeat the run with other forces",
)
BY_HAND = MovedOtherwise(
    "the force depends on the position only, and something outside the log moves the joint",
    "The force depends on the position only, without friction and without inertia. Such a drive "
    "bears a weight while a hand, or another joint, moves it. So no number of the law is "
    "estimated. Log the force of the hand, or let the drive move the joint",
)

BACKWARDS = MovedOtherwise(
    "the force works against the motion, as if its sign, or that of the position, were wrong",
    "By least squares, friction or inertia is below 0: the force works backwards. The sign of the "
    "force, or that of the position, may be wrong (sign = -1 in a mapping), or something outside "
    "the log moves the joint against its drive. So no number of the law is estimated. Correct the "
    "sign, or let the drive move the joint",
)


def moved_otherwise(readings: Readings, measures: Measures, inside: Flags) -> MovedOtherwise | None:
    """Return why the force has no information on friction; None if it may have.

    Parameters
    ----------
    readings : Readings
        Windows of all runs.
    measures : Measures
        Scales of the recording.
    inside : ndarray of bool, shape (W,)
        Windows within the drive's limit.
    """
    if works_backwards(readings):
        return BACKWARDS
    force = readings.force
    moved, friction = _law_forces(readings, measures, inside)
    usual, spread = abs(float(np.mean(force))), float(np.std(force))
    is_one_size = spread < AXIS_RULES.one_force * usual
    if is_one_size and relaxes(readings):
        return ONE_LEVEL
    if measures.rotary and is_one_size and readings.swings_alike:
        return RELAY if moved < AXIS_RULES.one_force * measures.force else None
    if spread < EXACTLY * usual:
        return ONE_LEVEL
    size = float(np.sqrt(np.mean((readings.drive @ readings.weights) ** 2)))
    if max(moved, friction) >= AXIS_RULES.no_friction * size:
        return None
    # Coefficients of the rough law are never below 0; the reversed force shows negative ones.
    reverse = _law_forces(replace(readings, force=-force), measures, inside)
    return BY_HAND if max(reverse) < AXIS_RULES.no_friction * size else BACKWARDS


def _law_forces(readings: Readings, measures: Measures, inside: Flags) -> tuple[float, float]:
    """Return the rms force of inertia and friction at top speed, by the rough law."""
    rough = rough_law_of(readings, inside)
    friction = rough.coulomb + rough.viscous * measures.speed
    return rough.mass * measures.acceleration, friction


def works_backwards(readings: Readings) -> bool:
    """Return whether least squares give friction, and possibly inertia, certainly below 0.

    Other forces on a joint make errors that neighbouring windows share. If friction alone is
    negative, its error must come from the scatter of whole stretches. If inertia is negative too,
    the scatter of windows is enough.

    Parameters
    ----------
    readings : Readings
        Rows of all runs.
    """
    pull = pull_columns(readings.mean_position, readings.way)
    columns = np.column_stack([readings.law_columns, pull])
    if readings.count < 2 * columns.shape[1]:
        return False
    columns = columns / np.maximum(np.abs(columns).max(axis=0), 1e-300)
    numbers = np.linalg.lstsq(columns, readings.force, rcond=None)[0]
    residual = readings.force - columns @ numbers
    inertia, friction = np.zeros((2, numbers.size))
    inertia[0], friction[1:3] = 1.0, columns[:, 1:3].mean(axis=0)
    inverse = np.linalg.pinv(columns.T @ columns)
    of_windows = np.mean(residual**2) * inverse
    if not _in_errors(friction, numbers, of_windows) < -SURELY:
        return False
    if _in_errors(inertia, numbers, of_windows) < -SURELY:
        return True
    names, stretch = np.unique(readings.piece, return_inverse=True)
    of_stretches = clustered_covariance(columns, residual, stretch, inverse)
    return (
        names.size >= AXIS_RULES.least_pieces
        and _in_errors(friction, numbers, of_stretches) < -SURELY
        and _in_errors(inertia, numbers, of_stretches) < SURELY
    )


def _in_errors(weights: Array, numbers: Array, covariance: Array) -> float:
    """Return a sum of numbers over its standard error; 0 if the error is unknown."""
    variance = float(weights @ covariance @ weights)
    return float(weights @ numbers) / variance**0.5 if variance > 0 else 0.0


DENSEST_S = 4e-5  # least plausible time between samples: 25 kHz
MANY_TURNS_RAD = 40.0  # implausible range of a joint whose force depends on position
NEAR_ZERO = 0.05  # force that counts as near zero, relative to the rms force
OFTEN = 0.01  # share of the windows with such a force from which it may be a magnitude


def likely_mistakes(
    readings: Readings, measures: Measures, interval_s: float, *, viscous: bool
) -> Iterator[str]:
    """Yield a sentence for each likely mistake.

    Parameters
    ----------
    readings : Readings
        Windows of all runs.
    measures : Measures
        Scales of the recording.
    interval_s : float
        Time between samples [s].
    viscous : bool
        Whether the law has viscous friction.
    """
    if works_backwards(readings):
        yield BACKWARDS.advice
    if measures.both_ways and _is_magnitude(readings, measures.force):
        yield (
            "The force is never below 0 and often at 0, while the axis moves both ways: is it a "
            "magnitude, without its sign?"
        )
    if interval_s < DENSEST_S:
        yield f"The log has {1 / interval_s:,.0f} samples a second: are its times in another unit?"
    speed = readings.mean_speed
    if viscous and np.ptp(speed) < AXIS_RULES.one_speed * float(speed.max()):
        yield (
            f"The axis runs at one speed, {speed.mean():.3g} {measures.unit('m')}/s, at which "
            "Coulomb and viscous friction cannot be separated: use --baseline coulomb, or run at "
            "other speeds too"
        )
    if measures.rotary and measures.pull and measures.stroke > MANY_TURNS_RAD:
        yield (
            f"The joint turns by {measures.stroke:,.0f} rad ({measures.stroke / 2 / np.pi:,.0f} "
            "turns), and its force depends on position: are its positions in degrees, or those of "
            "a motor before its gear?"
        )


def _is_magnitude(readings: Readings, force: float) -> bool:
    size = readings.drive @ readings.weights
    crosses = (size > 0) & (size < NEAR_ZERO * force)  # 0 itself may be a drive that is off
    return bool(readings.drive.min() >= 0 and np.mean(crosses) > OFTEN)

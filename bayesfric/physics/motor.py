"""The motor board: constant speed, a weight on one end (paper Sec. III.A).

The motor pulls the cable over the pulleys at a constant speed and raises (v > 0) or
lowers (v < 0) a weight. Signed friction is ``F = k_t (I − I_idle(v)) / r − m g``:
its size is fc of eq. (15), its sign that of v, and the nominal tension is
``T = m g + F / 2``, so that friction is implicit in itself and solved in closed form.

Functions take the coefficients of the pulley size and the conditions of runs, and broadcast over
their arguments.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from bayesfric.arrays import Array
from bayesfric.physics.friction import (
    Coefficients,
    equal_pulleys,
    recursive_friction,
    tension_slope,
)


class MotorCondition(NamedTuple):
    """What the experimenter chooses, as numbers or arrays of one length.

    Parameters
    ----------
    n_pulleys : array_like
        Number of pulleys.
    wrap_angle_deg : array_like
        Average individual wrap angle [deg].
    hanging_mass_kg : array_like
        The weight's mass [kg].
    velocity_m_s : array_like
        Cable speed, positive where the weight rises; never 0 [m/s].
    gravity_m_s2 : array_like
        Local acceleration of gravity [m/s²].
    """

    n_pulleys: ArrayLike
    wrap_angle_deg: ArrayLike
    hanging_mass_kg: ArrayLike
    velocity_m_s: ArrayLike
    gravity_m_s2: ArrayLike

    @property
    def weight_n(self) -> Array:
        """The weight m g [N]."""
        weight = np.asarray(self.hanging_mass_kg) * np.asarray(self.gravity_m_s2)
        return np.asarray(weight, dtype=np.float64)


def motor_friction(coefficients: Coefficients, condition: MotorCondition) -> Array:
    """Return the signed friction F, tension solved for together with it [N].

    ``sign(v) n (k m g + c2) / (1 − sign(v) n k / 2)`` with k = c1 + c3 (θ − 85°).
    """
    sign = np.sign(np.asarray(condition.velocity_m_s, dtype=np.float64))
    slope = tension_slope(coefficients, condition.n_pulleys, condition.wrap_angle_deg)
    constant = np.asarray(condition.n_pulleys) * np.asarray(coefficients.c2)
    friction = sign * (slope * condition.weight_n + constant) / (1 - 0.5 * sign * slope)
    return np.asarray(friction, dtype=np.float64)


def recursive_motor_friction(coefficients: Coefficients, condition: MotorCondition) -> Array:
    """Return the signed friction F with the tension taken down pulley by pulley [N].

    It is the tension at the motor less m g. The weight is at the pulled end where it rises and at
    the pulling end where it falls, so its side's tension m g is known exactly.
    """
    loss = equal_pulleys(coefficients, condition.n_pulleys, condition.wrap_angle_deg)
    rises = np.asarray(condition.velocity_m_s, dtype=np.float64) > 0
    raising = recursive_friction(loss, condition.weight_n, "load")
    lowering = -recursive_friction(loss, condition.weight_n, "drive")
    return np.where(rises, raising, lowering)


def tension_feedback(coefficients: Coefficients, condition: MotorCondition) -> Array:
    """Return by how much friction grows for each newton of a further drag [-].

    ``1 / (1 − sign(v) n k / 2)``, see :func:`motor_friction`.
    """
    sign = np.sign(np.asarray(condition.velocity_m_s, dtype=np.float64))
    slope = tension_slope(coefficients, condition.n_pulleys, condition.wrap_angle_deg)
    return np.asarray(1 / (1 - 0.5 * sign * slope), dtype=np.float64)


def nominal_tension(condition: MotorCondition, friction_n: ArrayLike) -> Array:
    """Return the mean tension of both ends at a signed friction F, T = m g + F / 2 [N]."""
    return np.asarray(condition.weight_n + 0.5 * np.asarray(friction_n), dtype=np.float64)


def load_current(
    condition: MotorCondition,
    friction_n: ArrayLike,
    torque_constant_n_m_per_a: ArrayLike,
    capstan_radius_m: ArrayLike,
) -> Array:
    """Return the current beyond that of the idle motor, (m g + F) r / k_t [A].

    Parameters
    ----------
    condition : MotorCondition
        Of the run.
    friction_n : array_like
        Signed friction F [N].
    torque_constant_n_m_per_a : array_like
        Torque constant k_t [N·m/A].
    capstan_radius_m : array_like
        Capstan radius r at the cable's centre line [m].
    """
    pull = condition.weight_n + np.asarray(friction_n)
    current = pull * np.asarray(capstan_radius_m) / np.asarray(torque_constant_n_m_per_a)
    return np.asarray(current, dtype=np.float64)

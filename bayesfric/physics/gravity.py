"""The gravity board: an Atwood machine over n pulleys (paper Sec. III.B).

Eq. (4) of the paper, ``(m1 + m2) a = (m1 − m2) g − fc``, with the nominal tension as the
mean of the two sides,
``T = ((m1 + m2) g − (m1 − m2) a) / 2``. Friction is linear in T and T is linear
in a, so the implicit equation is solved in closed form, and the acceleration is constant.
Friction at rest is set-valued: a cable that has stopped stays.

Functions take the coefficients of the pulley size and the conditions of trials, in which each
pulley is at the average wrap angle, and broadcast over their arguments.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from bayesfric.arrays import Array
from bayesfric.physics.friction import Coefficients, coulomb_friction, equal_pulleys, tension_slope

TRAVEL_M = 0.6
"""Travel of the cable in a trial of the paper's board [m]."""


class Condition(NamedTuple):
    """What the experimenter chooses, as numbers or arrays of one length.

    Parameters
    ----------
    n_pulleys : array_like
        Number of pulleys.
    wrap_angle_deg : array_like
        Average individual wrap angle [deg].
    mass_drive_kg : array_like
        Falling side, m1 [kg].
    mass_load_kg : array_like
        Rising side, m2 < m1 [kg].
    gravity_m_s2 : array_like
        Local acceleration of gravity [m/s²].
    """

    n_pulleys: ArrayLike
    wrap_angle_deg: ArrayLike
    mass_drive_kg: ArrayLike
    mass_load_kg: ArrayLike
    gravity_m_s2: ArrayLike

    @property
    def total_mass_kg(self) -> Array:
        """The moving mass m1 + m2 [kg]."""
        total = np.asarray(self.mass_drive_kg) + np.asarray(self.mass_load_kg)
        return np.asarray(total, dtype=np.float64)

    @property
    def drive_force_n(self) -> Array:
        """The driving force (m1 − m2) g [N]."""
        difference = np.asarray(self.mass_drive_kg) - np.asarray(self.mass_load_kg)
        return np.asarray(difference * np.asarray(self.gravity_m_s2), dtype=np.float64)


def nominal_tension(condition: Condition, acceleration_m_s2: ArrayLike) -> Array:
    """Return the mean tension of both sides, T = ((m1+m2) g − (m1−m2) a) / 2 [N].

    The acceleration is that of the drive side, downwards positive [m/s²].
    """
    gravity = np.asarray(condition.gravity_m_s2)
    difference = np.asarray(condition.mass_drive_kg) - np.asarray(condition.mass_load_kg)
    tension = condition.total_mass_kg * gravity - difference * np.asarray(acceleration_m_s2)
    return np.asarray(0.5 * tension, dtype=np.float64)


def coulomb_acceleration(coefficients: Coefficients, condition: Condition) -> Array:
    """Return the acceleration of eq. (4), tension solved for together with it [m/s²].

    Not above zero where friction holds a cable at rest.
    """
    return _drive_and_mass(coefficients, condition)[0]


def board_friction(coefficients: Coefficients, condition: Condition) -> Array:
    """Return fc of eq. (15) at the nominal tension of the moving board [N].

    Equal to (m1 − m2) g − (m1 + m2) a.
    """
    acceleration = coulomb_acceleration(coefficients, condition)
    return condition.drive_force_n - condition.total_mass_kg * acceleration


def recursive_board_friction(coefficients: Coefficients, condition: Condition) -> Array:
    """Return the friction of the moving board pulley by pulley, (m1 − m2) g − (m1 + m2) a [N].

    With the drive side at m1 (g − a) and the load side at m2 (g + a), the straight
    line between the two ends' tensions (:class:`bayesfric.physics.friction.TensionLoss`) is
    linear in a too.
    """
    loss = equal_pulleys(coefficients, condition.n_pulleys, condition.wrap_angle_deg)
    mass_drive = np.asarray(condition.mass_drive_kg, dtype=np.float64)
    weight = mass_drive * np.asarray(condition.gravity_m_s2)
    surplus = condition.drive_force_n - loss.share * weight - loss.constant_n
    acceleration = surplus / (condition.total_mass_kg - loss.share * mass_drive)
    friction = loss.share * (weight - mass_drive * acceleration) + loss.constant_n
    return np.asarray(friction, dtype=np.float64)


def tension_feedback(coefficients: Coefficients, condition: Condition) -> Array:
    """Return by how much friction grows for each newton of a further drag [-].

    A drag slows the board, which raises the nominal tension and with it friction: m1 + m2
    over the mass that multiplies a once T(a) is moved to the left.
    """
    return condition.total_mass_kg / _drive_and_mass(coefficients, condition)[1]


@dataclass(frozen=True)
class Trajectory:
    """Motion with constant acceleration from a given speed until it stops.

    Parameters
    ----------
    acceleration : ndarray
        While it moves [m/s²].
    start_speed : ndarray
        Speed at time and position 0, not negative [m/s].
    """

    acceleration: Array
    start_speed: Array

    @property
    def stop_time(self) -> Array:
        """Time at which the cable stops and friction holds it; inf if never [s]."""
        alpha, v0 = self.acceleration, self.start_speed
        with np.errstate(divide="ignore", invalid="ignore"):
            time = v0 / -alpha
        return np.where(alpha < 0, time, np.where((alpha == 0) & (v0 == 0), 0.0, np.inf))

    def speed(self, time_s: ArrayLike) -> Array:
        """Return the speed at a time ≥ 0 since the start [m/s]."""
        time = np.asarray(time_s, dtype=np.float64)
        return np.where(time < self.stop_time, self.start_speed + self.acceleration * time, 0.0)

    def position(self, time_s: ArrayLike) -> Array:
        """Return the distance travelled at a time ≥ 0 since the start [m]."""
        time = np.minimum(np.asarray(time_s, dtype=np.float64), self.stop_time)
        travel = self.start_speed * time + self.acceleration * time**2 * 0.5
        return np.asarray(travel, dtype=np.float64)

    def time_at(self, position_m: ArrayLike) -> Array:
        """Return when a distance ≥ 0 is reached; inf where the cable stops before [s]."""
        distance, alpha, v0 = np.broadcast_arrays(
            np.asarray(position_m, dtype=np.float64), self.acceleration, self.start_speed
        )
        with np.errstate(invalid="ignore", divide="ignore"):
            root = np.sqrt(v0**2 + 2 * alpha * distance)  # nan: stops before
            time = np.where(distance > 0, 2 * distance / (v0 + root), 0.0)
        return np.where(np.isfinite(time), time, np.inf)


def trajectory(
    coefficients: Coefficients,
    condition: Condition,
    *,
    start_speed_m_s: ArrayLike = 0.0,
    friction_factor: ArrayLike = 1.0,
) -> Trajectory:
    """Return the motion of eq. (4) in closed form.

    Parameters
    ----------
    coefficients : Coefficients
        Friction law of the pulley size.
    condition : Condition
        Of the trial.
    start_speed_m_s : array_like
        Speed at the start, not negative [m/s].
    friction_factor : array_like
        Scatter 1 + η + ε that multiplies the friction force of the condition and
        nothing else.

    Returns
    -------
    Trajectory
        Of the broadcast shape.
    """
    alpha, _ = _drive_and_mass(coefficients, condition)
    factor = np.asarray(friction_factor)
    frictionless = condition.drive_force_n / condition.total_mass_kg
    arrays = np.broadcast_arrays(
        frictionless + factor * (alpha - frictionless),
        np.asarray(start_speed_m_s, dtype=np.float64),
    )
    return Trajectory(*(np.array(array, dtype=np.float64) for array in arrays))


def _drive_and_mass(coefficients: Coefficients, condition: Condition) -> tuple[Array, Array]:
    """Return α [m/s²] and the mass that multiplies a once T(a) is moved to the left [kg]."""
    half_difference = 0.5 * (
        np.asarray(condition.mass_drive_kg) - np.asarray(condition.mass_load_kg)
    )
    slope = tension_slope(coefficients, condition.n_pulleys, condition.wrap_angle_deg)
    effective_mass = condition.total_mass_kg - slope * half_difference
    static_friction = coulomb_friction(
        coefficients,
        condition.n_pulleys,
        condition.wrap_angle_deg,
        nominal_tension(condition, 0.0),
    )
    return (condition.drive_force_n - static_friction) / effective_mass, effective_mass

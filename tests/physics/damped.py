"""Eq. (5) of the paper: the gravity board with viscous friction, a reference in closed form."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import elementwise

from bayesfric.arrays import Array
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.gravity import Condition, _drive_and_mass


@dataclass(frozen=True)
class DampedTrajectory:
    """Motion with acceleration α − β v from a given speed until it stops.

    Parameters
    ----------
    acceleration : ndarray
        α, acceleration at vanishing speed [m/s²].
    damping : ndarray
        β ≥ 0, viscous friction over mass [1/s].
    start_speed : ndarray
        Speed at time and position 0, not negative [m/s].
    """

    acceleration: Array
    damping: Array
    start_speed: Array

    @property
    def stop_time(self) -> Array:
        """Time at which the cable stops and friction holds it; inf if never [s]."""
        alpha, beta, v0 = self.acceleration, self.damping, self.start_speed
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = v0 / -alpha
            # log1p(z)/z → 1: one expression for β > 0 and β = 0
            z = beta * ratio
            time = ratio * np.where(z > 0, np.log1p(z) / np.where(z > 0, z, 1.0), 1.0)
        return np.where(alpha < 0, time, np.where((alpha == 0) & (v0 == 0), 0.0, np.inf))

    def speed(self, time_s: ArrayLike) -> Array:
        """Return the speed at a time ≥ 0 since the start [m/s]."""
        time = np.asarray(time_s, dtype=np.float64)
        z = self.damping * time
        speed = self.start_speed * np.exp(-z) + self.acceleration * time * _phi1(z)
        return np.where(time < self.stop_time, speed, 0.0)

    def position(self, time_s: ArrayLike) -> Array:
        """Return the distance travelled at a time ≥ 0 since the start [m]."""
        time = np.minimum(np.asarray(time_s, dtype=np.float64), self.stop_time)
        z = self.damping * time
        travel = self.start_speed * time * _phi1(z) + self.acceleration * time**2 * _phi2(z)
        return np.asarray(travel, dtype=np.float64)

    def time_at(self, position_m: ArrayLike) -> Array:
        """Return when a distance ≥ 0 is reached; inf where the cable stops before [s]."""
        distance, alpha, beta, v0 = np.broadcast_arrays(
            np.asarray(position_m, dtype=np.float64),
            self.acceleration,
            self.damping,
            self.start_speed,
        )
        with np.errstate(invalid="ignore", divide="ignore"):
            root = np.sqrt(v0**2 + 2 * alpha * distance)  # nan: stops before
            time = np.where(distance > 0, 2 * distance / (v0 + root), 0.0)
        time = np.where(np.isfinite(time), time, np.inf)
        viscous = (beta > 0) & (distance > 0)
        if viscous.any():
            time[viscous] = _viscous_time(
                DampedTrajectory(alpha[viscous], beta[viscous], v0[viscous]), distance[viscous]
            )
        return time


def damped_trajectory(
    coefficients: Coefficients,
    condition: Condition,
    *,
    start_speed_m_s: ArrayLike = 0.0,
    viscous_n_s_m: ArrayLike = 0.0,
    friction_factor: ArrayLike = 1.0,
) -> DampedTrajectory:
    """Return the motion of eqs. (4) and (5) in closed form.

    Parameters
    ----------
    coefficients : Coefficients
        Friction law of the pulley size.
    condition : Condition
        Of the trial.
    start_speed_m_s : array_like
        Speed at the start, not negative [m/s].
    viscous_n_s_m : array_like
        fv of eq. (5) for the whole board [N·s/m].
    friction_factor : array_like
        Scatter 1 + η + ε that multiplies the friction force of the condition and
        nothing else.

    Returns
    -------
    DampedTrajectory
        Of the broadcast shape.
    """
    alpha, effective_mass = _drive_and_mass(coefficients, condition)
    factor = np.asarray(friction_factor)
    frictionless = condition.drive_force_n / condition.total_mass_kg
    arrays = np.broadcast_arrays(
        frictionless + factor * (alpha - frictionless),
        factor * np.asarray(viscous_n_s_m) / effective_mass,
        np.asarray(start_speed_m_s, dtype=np.float64),
    )
    return DampedTrajectory(*(np.array(array, dtype=np.float64) for array in arrays))


def _phi1(z: Array) -> Array:
    """Return (1 − e^−z) / z, 1 at z = 0."""
    safe = np.where(z == 0, 1.0, z)
    return np.where(z == 0, 1.0, -np.expm1(-safe) / safe)


def _phi2(z: Array) -> Array:
    """Return (z − 1 + e^−z) / z², 1/2 at z = 0."""
    small = np.abs(z) < 0.5
    series = np.zeros_like(z)
    for k in range(16, 1, -1):  # Σ (−z)^(k−2) / k!, by Horner; 1e-16 at |z| = 0.5
        series = (1.0 - z * series) / k
    safe = np.where(small, 1.0, z)
    return np.where(small, series, (safe + np.expm1(-safe)) / safe**2)


def _viscous_time(motion: DampedTrajectory, distance: Array) -> Array:
    """Return the time to a distance > 0 where β > 0, by bracketed root finding."""
    time = np.full_like(distance, np.inf)
    stop = motion.stop_time
    stops = np.isfinite(stop)
    coasting = np.where(motion.acceleration > 0, np.inf, motion.start_speed / motion.damping)
    reach = np.where(stops, motion.position(np.where(stops, stop, 0.0)), coasting)
    reached = reach > distance
    alpha, beta, v0, d = (
        motion.acceleration[reached],
        motion.damping[reached],
        motion.start_speed[reached],
        distance[reached],
    )
    upper = np.where(stops[reached], stop[reached], 1.0)
    while True:  # double the bracket of those that never stop until it holds the root
        short = DampedTrajectory(alpha, beta, v0).position(upper) < d
        if not short.any():
            break
        upper = np.where(short, 2 * upper, upper)

    def overshoot(t: Array, a: Array, b: Array, v: Array, x: Array) -> Array:
        return DampedTrajectory(a, b, v).position(t) - x

    result = elementwise.find_root(
        overshoot,
        (np.zeros_like(upper), upper),
        args=(alpha, beta, v0, d),
        tolerances={"xatol": 1e-15, "xrtol": 1e-14},
    )
    time[reached] = result.x
    return time

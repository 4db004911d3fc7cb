"""Simulated motion and events of the gravity board's trials with effects."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from bayesfric.arrays import Array
from bayesfric.effects import Reading, State
from bayesfric.physics.friction import Coefficients, coulomb_friction
from bayesfric.physics.gravity import Condition, nominal_tension, trajectory
from bayesfric.physics.stepped import SteppedMotion, step_board
from bayesfric.rigs.acting import PhasedEffect, of_kind, total

LONGEST = 3.0  # longest simulated time, relative to the duration of a trial without effects
STEPS = 900  # steps of the Runge-Kutta method in this time
CORRECTIONS = 3  # iterations of the acceleration, which changes tension and so itself by about 1 %
SPEED_STEP_S = 1e-3  # time step of the difference quotient of an acceleration


class TrialMotion(Protocol):
    """Motion of N trials, in closed form or by steps; arrays of shape (N, …)."""

    def time_at(self, position_m: Array, /) -> Array:
        """Return the times at which positions are reached [s]."""

    def speed(self, time_s: Array, /) -> Array:
        """Return the speed at given times [m/s]."""


def trial_motion(
    law: Coefficients,
    condition: Condition,
    factor: Array,
    acting: Sequence[PhasedEffect],
    around: Mapping[str, Any],
    distance_m: float,
    wander: Callable[[Array], Array] | None = None,
    start_speed_m_s: Array | float = 0.0,
) -> SteppedMotion:
    """Integrate the motion of trials from their release, with the forces of effects.

    Parameters
    ----------
    law : Coefficients
        Coefficients of each trial, shape (N,).
    condition : Condition
        Condition of each trial.
    factor : ndarray, shape (N,)
        Factor of friction and of effects on friction (1 plus scatter); effects on the drive do
        not have it.
    acting : sequence of PhasedEffect
        Effects; those on readings and currents are ignored.
    around : mapping
        Further fields of :class:`State`, see :func:`surroundings`.
    distance_m : float
        Travel at which the integration ends [m].
    wander : callable or None
        Function of the travel of each trial, shape (N,), that returns a term of `factor`.
    start_speed_m_s : ndarray, shape (N,), or float
        Speed at the release [m/s].
    """
    plain = trajectory(law, condition).time_at(np.full_like(factor, distance_m))
    duration = LONGEST * np.where(np.isfinite(plain), plain, 1.0)

    def acceleration(travel: Array, speed: Array) -> Array:
        along = {**around, "travel_m": travel}
        factor_along = factor if wander is None else factor + wander(travel)
        return _acceleration(law, condition, factor_along, acting, along, speed)

    return step_board(acceleration, duration, STEPS, distance_m, start_speed_m_s)


def _acceleration(
    law: Coefficients,
    condition: Condition,
    factor: Array,
    acting: Sequence[PhasedEffect],
    along: Mapping[str, Any],
    speed: Array,
) -> Array:
    """Return the acceleration of moving trials, with effects [m/s²]."""
    n, wrap, mass = condition.n_pulleys, condition.wrap_angle_deg, condition.total_mass_kg
    on_friction, on_drive = of_kind(acting, "friction"), of_kind(acting, "drive")

    def state_at(a: Array) -> State:
        tension = nominal_tension(condition, a)
        return State.of(law, n, wrap, tension, speed, acceleration_m_s2=a, **along)

    def friction(state: State) -> Array:
        law_friction = coulomb_friction(law, n, wrap, state.tension_n)
        return np.asarray(law_friction + total(on_friction, state))

    def unscattered(a: Array) -> Array:
        state = state_at(a)
        force = condition.drive_force_n - friction(state) - total(on_drive, state)
        return np.asarray(force / mass)

    # By definition, scatter multiplies friction at the tension of the motion without scatter.
    mean = _fixed_point(unscattered, condition.drive_force_n / mass)
    scattered = factor * friction(state_at(mean))
    if not on_drive:
        return np.asarray((condition.drive_force_n - scattered) / mass)
    return _fixed_point(
        lambda a: (condition.drive_force_n - scattered - total(on_drive, state_at(a))) / mass, mean
    )


def _fixed_point(function: Callable[[Array], Array], start: Array) -> Array:
    """Return the x with function(x) = x; the first iteration is exact for a linear function."""
    x = function(start)
    slope = function(start + 1) - x
    x = start + (x - start) / (1 - slope)
    for _ in range(CORRECTIONS - 1):
        x = x + (function(x) - x) / (1 - slope)
    return x


def passing_times(
    motion: TrialMotion,
    place_m: Array,
    displacement_m: Array,
    condition: Condition,
    magnets_per_revolution: int,
    acting: Sequence[PhasedEffect],
) -> Array:
    """Return the times at which magnets pass the sensors, with effects on readings.

    Parameters
    ----------
    motion : TrialMotion
        Motion of N trials.
    place_m : ndarray, shape (N, sensors, events)
        Travel at which a magnet passes without such effects [m].
    displacement_m : ndarray, shape (events,)
        Displacement that is recorded for each event [m].
    condition : Condition
        Condition of each trial.
    magnets_per_revolution : int
        Number of magnets of the sensor pulley.
    acting : sequence of PhasedEffect
        Effects; only those on readings are used.

    Returns
    -------
    ndarray, shape (N, sensors, events)
        Times since the release; inf if a trial does not move that far [s].
    """
    time = motion.time_at(place_m)
    on_reading = of_kind(acting, "reading")
    if not on_reading:
        return time
    reached = np.where(np.isfinite(time), time, 0.0)
    speed = motion.speed(reached)

    def whole(value: ArrayLike) -> Array:
        return np.broadcast_to(np.asarray(value, dtype=np.float64), place_m.shape)

    reading = Reading(
        displacement_m=whole(displacement_m),
        event=whole(np.arange(displacement_m.size)),
        is_load=whole(np.array([0.0, 1.0])[:, None]),
        time_s=reached,
        speed_m_s=speed,
        acceleration_m_s2=(motion.speed(reached + SPEED_STEP_S) - speed) / SPEED_STEP_S,
        mass_drive_kg=whole(np.reshape(condition.mass_drive_kg, (-1, 1, 1))),
        mass_load_kg=whole(np.reshape(condition.mass_load_kg, (-1, 1, 1))),
        magnets_per_revolution=magnets_per_revolution,
    )
    return motion.time_at(place_m + total(on_reading, reading))

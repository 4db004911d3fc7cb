"""How effects change the trials of the gravity board: their motion and their readings."""

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

STEPS = 900  # of Runge-Kutta, over LONGEST times the time without effects
LONGEST = 3.0
CORRECTIONS = 3  # of an acceleration that its own tension changes, by a hundredth of itself
SPEED_STEP_S = 1e-3  # over which speeds are compared for an acceleration


class TrialMotion(Protocol):
    """Motion of trials, closed or stepped; arrays of shape (N, …)."""

    def time_at(self, position_m: Array, /) -> Array:
        """Return when distances are reached [s]."""

    def speed(self, time_s: Array, /) -> Array:
        """Return the speed at times [m/s]."""


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
    """Integrate trials from their release with all forces that effects add.

    Parameters
    ----------
    law : Coefficients
        Of each trial, shape (N,).
    condition : Condition
        Of each trial.
    factor : ndarray, shape (N,)
        Scatter, of friction and of effects on friction; a drive is not scattered.
    acting : sequence of PhasedEffect
        Those on friction and drive are used.
    around : mapping
        Further fields of :class:`State`, see :func:`surroundings`.
    distance_m : float
        How far the trials are followed [m].
    wander : callable or None
        Travel of each trial, shape (N,), to what is added to `factor` there.
    start_speed_m_s : ndarray, shape (N,), or float
        At the release [m/s].
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
    """Return the acceleration of trials that move, effects included [m/s²]."""
    n, wrap, mass = condition.n_pulleys, condition.wrap_angle_deg, condition.total_mass_kg
    on_friction, on_drive = of_kind(acting, "friction"), of_kind(acting, "drive")

    def state(a: Array) -> State:
        tension = nominal_tension(condition, a)
        return State.of(law, n, wrap, tension, speed, acceleration_m_s2=a, **along)

    def friction(at: State) -> Array:
        return np.asarray(coulomb_friction(law, n, wrap, at.tension_n) + total(on_friction, at))

    def unscattered(a: Array) -> Array:
        at = state(a)
        force = condition.drive_force_n - friction(at) - total(on_drive, at)
        return np.asarray(force / mass)

    # Scatter multiplies the friction of the condition: tension is that without it.
    mean = _fixed_point(unscattered, condition.drive_force_n / mass)
    scattered = factor * friction(state(mean))
    if not on_drive:
        return np.asarray((condition.drive_force_n - scattered) / mass)
    return _fixed_point(
        lambda a: (condition.drive_force_n - scattered - total(on_drive, state(a))) / mass, mean
    )


def _fixed_point(of: Callable[[Array], Array], start: Array) -> Array:
    """Return x = of(x): at once where `of` is a straight line, else by corrections."""
    x = of(start)
    slope = of(start + 1) - x
    x = start + (x - start) / (1 - slope)
    for _ in range(CORRECTIONS - 1):
        x = x + (of(x) - x) / (1 - slope)
    return x


def passing_times(
    motion: TrialMotion,
    place_m: Array,
    displacement_m: Array,
    condition: Condition,
    magnets_per_revolution: int,
    acting: Sequence[PhasedEffect],
) -> Array:
    """Return when magnets pass, those of effects on readings off their places.

    Parameters
    ----------
    motion : TrialMotion
        Of N trials.
    place_m : ndarray, shape (N, sensors, events)
        Travel at which a magnet would pass without these effects [m].
    displacement_m : ndarray, shape (events,)
        What is written down [m].
    condition : Condition
        Of each trial.
    magnets_per_revolution : int
        Of the sensor pulley.
    acting : sequence of PhasedEffect
        Those on readings are used.

    Returns
    -------
    ndarray, shape (N, sensors, events)
        Since the release; inf where a trial never gets there [s].
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

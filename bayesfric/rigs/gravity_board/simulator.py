"""Simulation of the gravity board: trials in random order, and their Hall events.

A trial is released at rest or with a push. Its friction is that of the law and of effects on
friction, times 1 + η + κ n c2 / fc + ε + ζ(x). η and κ are drawn for each assembly, ε for each
trial, and ζ is a process along the travel of each trial. Magnets pass a sensor after each
`hall_spacing_m` of travel. Each has a position error, to which effects on readings are added. The
clock has an error too, and its times are rounded.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from bayesfric.arrays import Array, Flags
from bayesfric.effects import Reading, State
from bayesfric.inference.cosines import MODES, cosine_variances, cosines
from bayesfric.physics.friction import Coefficients, coulomb_friction
from bayesfric.physics.gravity import (
    TRAVEL_M,
    Condition,
    Trajectory,
    board_friction,
    nominal_tension,
    trajectory,
)
from bayesfric.physics.stepped import SteppedMotion, step_board
from bayesfric.recording.tables import RigConstants
from bayesfric.rigs.acting import PhasedEffect, draw_phases, of_kind, surroundings, total
from bayesfric.rigs.gravity_board.event_trains import SENSORS
from bayesfric.rigs.gravity_board.trial_motion import trial_condition
from bayesfric.rigs.protocols import Assembly, Protocol
from bayesfric.rigs.truth import Truth, laws_of

LONGEST = 3.0  # longest simulated time, relative to the duration of a trial without effects
STEPS = 900  # steps of the Runge-Kutta method in this time
CORRECTIONS = 3  # iterations of the acceleration, which changes tension and so itself by about 1 %
SPEED_STEP_S = 1e-3  # time step of the difference quotient of an acceleration


TrialMotion = Trajectory | SteppedMotion
"""Motion of N trials, in closed form or by steps; arrays of shape (N, …)."""


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


LEAST_PATH_M = 0.001  # least travel before the first event, so that the cable moves there
LEAST_MOTION_M = 1e-6  # travel below which a trial did not move
RELEASE_WINDOW_S = 0.3  # longest time from the start of the clock to the release
LEAST_EVENTS = 5  # of each trial and sensor, by the recording format
PAST_M = 0.05  # simulated travel beyond TRAVEL_M, for magnets that are off their places


def trials_in_random_order(design: Protocol, rng: np.random.Generator) -> pd.DataFrame:
    """Return a table of trials, with assemblies and the trials of each in random order."""
    assemblies = list(design.assemblies())
    rows: list[dict[str, Any]] = []
    for place, chosen in enumerate(rng.permutation(len(assemblies)), start=1):
        assembly: Assembly = assemblies[chosen]
        for index in rng.permutation(len(assembly.trials)):
            order = len(rows) + 1
            rows.append(
                {
                    "trial": f"g{order:04d}",
                    "order": order,
                    "setup": f"s{place:03d}",
                    "pulley_size": assembly.pulley_size,
                    "n_pulleys": assembly.n_pulleys,
                    "wrap_angle_deg": assembly.wrap_angle_deg,
                    "mass_drive_kg": assembly.trials[index].mass_drive_kg,
                    "mass_load_kg": assembly.trials[index].mass_load_kg,
                    "drive_end": ("left", "right")[order % 2],
                }
            )
    return pd.DataFrame(rows)


def draw_events(
    trials: pd.DataFrame,
    rig: RigConstants,
    truth: Truth,
    scatter_rng: np.random.Generator,
    sensor_rng: np.random.Generator,
    noise_rng: np.random.Generator,
    effects_rng: np.random.Generator,
) -> tuple[pd.DataFrame, Flags, Flags]:
    """Return the events, which trials have enough of them, and which did not move."""
    assert rig.hall_spacing_m and rig.magnets_per_revolution and rig.timer_resolution_s
    spacing, tick = rig.hall_spacing_m, rig.timer_resolution_s
    setup_index = pd.factorize(trials["setup"])[0]
    law, condition = laws_of(truth, trials["pulley_size"]), trial_condition(trials, rig)
    eta = truth.omega * scatter_rng.standard_normal(setup_index.max() + 1)
    factor = 1 + eta[setup_index] + truth.tau * scatter_rng.standard_normal(len(trials))
    kappa = truth.omega_intercept * scatter_rng.standard_normal(setup_index.max() + 1)
    if truth.assembly_freedom:
        far = scatter_rng.chisquare(truth.assembly_freedom, eta.size) / truth.assembly_freedom
        factor += eta[setup_index] * (1 / np.sqrt(far[setup_index]) - 1)
        kappa /= np.sqrt(far)
    intercept = np.asarray(condition.n_pulleys) * np.asarray(law.c2)
    factor += kappa[setup_index] * intercept / board_friction(law, condition)
    wander = _draw_wander(truth, len(trials), scatter_rng)
    push = truth.push * np.abs(scatter_rng.standard_normal(len(trials)))

    # Arrays of trial × sensor × event; events that did not happen are masked below.
    shape = (len(trials), len(SENSORS))
    rotation = spacing * sensor_rng.uniform(0, rig.magnets_per_revolution, shape)
    first = LEAST_PATH_M + rotation % spacing  # the first magnet is rotation // spacing
    release = sensor_rng.uniform(0, RELEASE_WINDOW_S, len(trials))
    grid = np.arange(int(TRAVEL_M / spacing) + 1, dtype=np.float64) * spacing
    place = first[:, :, None] + grid
    magnet = place + truth.sigma_x * noise_rng.standard_normal(place.shape)
    clock = truth.sigma_t * noise_rng.standard_normal(place.shape)
    acting = draw_phases(truth, len(trials), len(SENSORS), effects_rng)
    motion = _motion(law, condition, factor, acting, surroundings(trials, rig), wander, push)
    per_turn = rig.magnets_per_revolution
    reached = passing_times(motion, magnet, grid, condition, per_turn, acting)
    passed = reached + release[:, None, None] + clock
    seen = (place <= TRAVEL_M) & np.isfinite(passed)
    moved = (seen.sum(axis=2) >= LEAST_EVENTS).all(axis=1)
    seen &= moved[:, None, None]

    which_trial, which_sensor, which_event = np.nonzero(seen)
    events = pd.DataFrame(
        {
            "trial": trials["trial"].to_numpy()[which_trial],
            "sensor": np.array(SENSORS)[which_sensor],
            "displacement_m": grid[which_event],
            "time_s": np.round(passed[seen] / tick) * tick,
        }
    )
    start = motion.time_at(np.full((len(trials), 1, 1), LEAST_MOTION_M))
    return events, moved, ~np.isfinite(start[:, 0, 0])


def _draw_wander(
    truth: Truth, count: int, rng: np.random.Generator
) -> Callable[[Array], Array] | None:
    """Return ζ as a function of the travel of each trial, shape (N,); None without wander."""
    if not truth.wander:
        return None
    variance = cosine_variances(truth.wander_length / TRAVEL_M, MODES)
    drawn = truth.wander * np.sqrt(variance)[:, None] * rng.standard_normal((MODES, count))
    return lambda travel: np.asarray((drawn * cosines(travel / TRAVEL_M, MODES)).sum(axis=0))


def _motion(
    law: Coefficients,
    condition: Condition,
    factor: Array,
    acting: Sequence[PhasedEffect],
    around: Mapping[str, Any],
    wander: Callable[[Array], Array] | None,
    push_m_s: Array,
) -> TrialMotion:
    """Return the motion of each trial from its release, shape (N, …)."""
    if wander or of_kind(acting, "friction") or of_kind(acting, "drive"):
        end = TRAVEL_M + PAST_M
        return trial_motion(law, condition, factor, acting, around, end, wander, push_m_s)
    condition_columns = [np.reshape(np.asarray(part), (-1, 1, 1)) for part in condition]
    columns = Coefficients(*(np.asarray(column)[:, None, None] for column in law))
    return trajectory(
        columns,
        Condition(*condition_columns),
        start_speed_m_s=push_m_s[:, None, None],
        friction_factor=factor[:, None, None],
    )

"""The gravity board, simulated: trials in their order, and their Hall events.

A trial is released at rest; its friction is that of the law and of the effects, times
1 + η + ε, with η drawn once for each assembly and ε once for each trial. Magnets pass a
sensor each `hall_spacing_m` of travel, with a position error each, and the clock adds
its own error before it rounds.
"""

from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bayesfric.boards.gravity import Condition, nominal_tension, trajectory
from bayesfric.boards.stepped import step_board
from bayesfric.effects import State
from bayesfric.friction import Coefficients, coulomb_friction
from bayesfric.protocols import Assembly, Protocol
from bayesfric.recording.tables import Rig
from bayesfric.simulate.truth import AppliedEffect, Truth, laws_of

__all__ = ["SENSORS", "TRAVEL_M", "conditions_of", "draw_events", "lay_trials"]

Array = NDArray[np.float64]
SENSORS = ("drive", "load")
TRAVEL_M = 0.6
LEAST_PATH_M = 0.001  # from release to the first event, so that the cable moves there
RELEASE_WINDOW_S = 0.3  # the release comes this long, at most, after the clock starts
LEAST_EVENTS = 5  # of a trial and sensor, by the recording format
STEPS = 900  # of Runge-Kutta, over LONGEST times the time without effects
LONGEST = 3.0
TENSION_ITERATIONS = 5  # friction changes by a hundredth of what the tension does


def lay_trials(design: Protocol, rng: np.random.Generator) -> pd.DataFrame:
    """Lay the assemblies, and the trials of each, in a random order."""
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
    rig: Rig,
    truth: Truth,
    scatter_rng: np.random.Generator,
    sensor_rng: np.random.Generator,
    noise_rng: np.random.Generator,
) -> tuple[pd.DataFrame, NDArray[np.bool_]]:
    """Return the events, and which trials gave enough of them."""
    assert rig.hall_spacing_m and rig.magnets_per_revolution and rig.timer_resolution_s
    spacing, tick = rig.hall_spacing_m, rig.timer_resolution_s
    setup_index = pd.factorize(trials["setup"])[0]
    eta = truth.omega * scatter_rng.standard_normal(setup_index.max() + 1)
    factor = 1 + eta[setup_index] + truth.tau * scatter_rng.standard_normal(len(trials))

    # Column by column: trial × sensor × event, made rectangular and then masked.
    shape = (len(trials), len(SENSORS))
    rotation = spacing * sensor_rng.uniform(0, rig.magnets_per_revolution, shape)
    first = LEAST_PATH_M + rotation % spacing  # the first magnet is rotation // spacing
    release = sensor_rng.uniform(0, RELEASE_WINDOW_S, len(trials))
    grid = np.arange(int(TRAVEL_M / spacing) + 1) * spacing
    place = first[:, :, None] + grid
    law = laws_of(truth, trials["pulley_size"])
    condition = conditions_of(trials, rig)
    magnet = place + truth.sigma_x * noise_rng.standard_normal(place.shape)
    clock = truth.sigma_t * noise_rng.standard_normal(place.shape)
    reached = _reached(law, condition, factor, truth, magnet)
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
    return events, moved


def conditions_of(trials: pd.DataFrame, rig: Rig) -> Condition:
    """Return the condition of each trial, arrays of shape (N,)."""
    return Condition(
        trials["n_pulleys"].to_numpy(),
        trials["wrap_angle_deg"].to_numpy(),
        trials["mass_drive_kg"].to_numpy(),
        trials["mass_load_kg"].to_numpy(),
        rig.gravity_m_s2,
    )


def _reached(
    law: Coefficients, condition: Condition, factor: Array, truth: Truth, place: Array
) -> Array:
    """Return when each trial reaches its places, shape (N, sensors, events); inf if never [s]."""
    effects = [applied for applied in truth.effects if applied.effect.acts_on == "friction"]
    if effects:
        still = np.zeros_like(factor)
        plain = trajectory(law, condition).time_at(still + TRAVEL_M)
        duration = LONGEST * np.where(np.isfinite(plain), plain, 1.0)

        def acceleration(speed: Array) -> Array:
            return _acceleration(law, condition, factor, effects, speed)

        return step_board(acceleration, duration, STEPS).time_at(place)
    each = [np.reshape(np.asarray(part), (-1, 1, 1)) for part in condition]
    columns = Coefficients(*(np.asarray(column)[:, None, None] for column in law))
    motion = trajectory(columns, Condition(*each), friction_factor=factor[:, None, None])
    return motion.time_at(place)


def _acceleration(
    law: Coefficients,
    condition: Condition,
    factor: Array,
    effects: list[AppliedEffect],
    speed: Array,
) -> Array:
    """Return the acceleration of trials that move, effects included [m/s²]."""
    n, wrap, mass = condition.n_pulleys, condition.wrap_angle_deg, condition.total_mass_kg
    friction = np.zeros_like(speed)
    for _ in range(TENSION_ITERATIONS):
        unscattered = (condition.drive_force_n - friction) / mass
        state = State.of(law, n, wrap, nominal_tension(condition, unscattered), speed)
        friction = coulomb_friction(law, n, wrap, state.tension_n)
        friction = friction + sum(applied(state) for applied in effects)
    return np.asarray((condition.drive_force_n - factor * friction) / mass)

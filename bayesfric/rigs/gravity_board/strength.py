"""The change of the gravity board's trials by an effect, relative to their friction."""

import numpy as np

from bayesfric.arrays import Array
from bayesfric.effects import Reading, State
from bayesfric.physics.gravity import TRAVEL_M, nominal_tension, trajectory
from bayesfric.recording.tables import RigConstants
from bayesfric.rigs.changes import Change, around_rows, at_times, law_column
from bayesfric.rigs.gravity_board.simulator import trials_in_random_order
from bayesfric.rigs.gravity_board.trial_motion import trial_condition
from bayesfric.rigs.protocols import Protocol
from bayesfric.rigs.truth import AppliedEffect, Truth, laws_of

TIMES = 33  # number of times in a trial
READING_TIMES = 513  # number of times for errors of readings, which may oscillate
DERIVATIVE_SHARE = 1e-4  # time step of a second derivative, relative to the trial's duration


def change_of_trials(design: Protocol, constants: RigConstants, truth: Truth) -> Change:
    """Return a function that computes the relative change of each trial's friction over time."""
    trials = trials_in_random_order(design, np.random.default_rng(0))
    condition = trial_condition(trials, constants)
    law = laws_of(truth, trials["pulley_size"])
    motion = trajectory(law, condition)
    whole = motion.time_at(np.full(len(trials), TRAVEL_M))
    times = np.linspace(0, 1, TIMES) * np.where(np.isfinite(whole), whole, 0.0)[:, None]
    acceleration = motion.acceleration[:, None]
    n, wrap = (np.asarray(part)[:, None] for part in condition[:2])
    state = State.of(
        law_column(law),
        n,
        wrap,
        nominal_tension(condition, motion.acceleration)[:, None],
        acceleration * times,
        travel_m=acceleration * times**2 / 2,
        acceleration_m_s2=acceleration,
        **around_rows(trials, constants),
    )
    return lambda applied: at_times(applied(state) / state.friction_n, times.shape)


def change_of_readings(design: Protocol, constants: RigConstants, truth: Truth) -> Change:
    """Return a function that computes the change of friction equivalent to errors of readings.

    The equivalent force is (m1 + m2) times the second derivative of the mean error of both sensors,
    along the motion of the law. The result is relative to friction.
    """
    trials = trials_in_random_order(design, np.random.default_rng(0))
    condition = trial_condition(trials, constants)
    motion = trajectory(laws_of(truth, trials["pulley_size"]), condition)
    whole = motion.time_at(np.full(len(trials), TRAVEL_M))
    assert constants.hall_spacing_m and constants.magnets_per_revolution
    spacing, magnets = constants.hall_spacing_m, constants.magnets_per_revolution
    moves = np.isfinite(whole)
    # Arrays of trial × sensor × time, without trials that stall.
    acceleration = motion.acceleration[moves][:, None, None]
    drive, load = (np.asarray(m)[moves][:, None, None] for m in condition[2:4])
    duration = whole[moves][:, None, None]
    times = np.linspace(0, 1, READING_TIMES) * duration
    friction = condition.drive_force_n[moves][:, None] - (drive + load)[:, 0] * acceleration[:, 0]

    def reading(time: Array) -> Reading:
        def whole(value: Array) -> Array:
            return np.broadcast_to(value, (len(time), 2, time.shape[-1]))

        travel = acceleration * time**2 / 2
        return Reading(
            displacement_m=whole(travel),
            event=whole(travel / spacing),
            is_load=whole(np.array([[0.0], [1.0]])),
            time_s=whole(time),
            speed_m_s=whole(acceleration * time),
            acceleration_m_s2=whole(acceleration),
            mass_drive_kg=whole(drive),
            mass_load_kg=whole(load),
            magnets_per_revolution=magnets,
        )

    def change(applied: AppliedEffect) -> Array:
        step = DERIVATIVE_SHARE * duration
        before, now, after = (applied(reading(times + k * step)) for k in (-1, 0, 1))
        bend = (after - 2 * now + before) / step**2
        # Phases of the two sensors are independent, so squares are added.
        mean = np.sqrt((bend**2).sum(axis=-2)) / 2 if applied.effect.components else bend.mean(-2)
        return np.asarray((drive + load)[:, 0] * mean / friction)

    return change

"""Recordings with parts left out, or measured by other means: what many tests fit instead."""

import dataclasses

import numpy as np

from bayesfric.recording.tables import Gravity, Motor
from bayesfric.rigs.gravity_board.trial_motion import pilot_fits

ACCELERATION_SD = 0.002  # m/s²


def with_trials(recording, chosen, **columns):
    """The chosen trials alone, of the gravity board."""
    gravity = recording.gravity
    trials = gravity.trials[chosen].assign(**columns).reset_index(drop=True)
    events = gravity.events[gravity.events["trial"].isin(trials["trial"])]
    return dataclasses.replace(
        recording, gravity=Gravity(trials, events.reset_index(drop=True)), motor=None
    )


def of_size(recording, size):
    return recording.gravity.trials["pulley_size"] == size


def one_size(recording, size):
    """What was recorded of one pulley size, on both boards."""
    gravity = with_trials(recording, of_size(recording, size)).gravity
    runs = recording.motor.runs[recording.motor.runs["pulley_size"] == size]
    motor = Motor(runs.reset_index(drop=True), recording.motor.idle)
    return dataclasses.replace(recording, gravity=gravity, motor=motor)


def by_acceleration(recording, chosen=slice(None), *, sd_stated=True):
    """Chosen trials by an acceleration with an error, instead of their events.

    A trial is then one number: likelihoods, and all that is built on them, are many times
    faster.
    """
    trials, events = recording.gravity.trials, recording.gravity.events
    taken = np.zeros(len(trials), dtype=bool)
    taken[chosen] = True
    error = ACCELERATION_SD * np.random.default_rng(3).standard_normal(len(trials))
    measured = pilot_fits(events, trials["trial"]).acceleration + error
    trials = trials.assign(acceleration_m_s2=np.where(taken, measured, np.nan))
    if sd_stated:
        trials["acceleration_sd_m_s2"] = np.where(taken, ACCELERATION_SD, np.nan)
    events = events[~events["trial"].isin(trials["trial"][taken])].reset_index(drop=True)
    rig = recording.rig
    if events.empty:
        rig = dataclasses.replace(
            rig, hall_spacing_m=None, magnets_per_revolution=None, timer_resolution_s=None
        )
    return dataclasses.replace(recording, rig=rig, gravity=Gravity(trials, events))

"""A few trials with Hall events, their likelihood, and the truth that they were simulated with."""

import dataclasses

import numpy as np

from bayesfric.analysis import Analysis
from bayesfric.observation.exact import ExactLikelihood
from bayesfric.recording.tables import Gravity
from bayesfric.rigs.gravity_board.likelihood import GravityModel
from bayesfric.rigs.gravity_board.screening import screen_trials
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import Truth, simulate_recording

SPACING = 0.0098
TICK = 4e-6  # of the clock [s]
TRUTH = Truth()
NOISE = ("tau", "omega", "omega_intercept", "wander", "wander_length", "sigma_x", "sigma_t")


def truth_by_name(truth=TRUTH):
    values = {
        f"{name}[{size}]": float(value)
        for size, law in truth.coefficients.items()
        for name, value in law._asdict().items()
    }
    return values | {name: getattr(truth, name) for name in NOISE}


def one_point(values):
    return {name: np.array([value]) for name, value in values.items()}


def few_trials(trials, events_each, seed=3, sensors=("drive", "load")):
    """The first trials of a simulated recording, with a few events of each sensor."""
    design = Protocol({(9, 85.0): 1}, (6.0, 16.0), (), 2)
    recording = simulate_recording(design, seed=seed)
    kept = recording.gravity.trials.iloc[:trials].reset_index(drop=True)
    events = recording.gravity.events
    events = events[events["trial"].isin(kept["trial"]) & events["sensor"].isin(sensors)]
    events = events.groupby(["trial", "sensor"], sort=False).head(events_each)
    gravity = Gravity(kept, events.reset_index(drop=True))
    return dataclasses.replace(recording, gravity=gravity)


def gravity_likelihood(gravity, rig, *arguments, **options):
    return ExactLikelihood(GravityModel(gravity, rig, *arguments, **options))


def likelihood_of(recording, analysis=None):
    screened = screen_trials(recording.gravity, recording.rig)
    return gravity_likelihood(screened.gravity, recording.rig, analysis or Analysis())


def design(events):
    """Time since the trial's first event, and the columns −o_drive, −o_load, v0."""
    tau = events["time_s"].to_numpy() - events["time_s"].min()
    offsets = [-(events["sensor"] == s).to_numpy(float) for s in events["sensor"].unique()]
    return tau, np.column_stack([*offsets, tau])

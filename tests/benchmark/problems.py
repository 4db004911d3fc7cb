"""The posteriors of the benchmark, and the same as plain arrays for samplers that are not ours.

Event level is what `fit` samples: Hall events, reduced to quadratic forms. Trial level takes
each trial as one acceleration with its standard error. Peers get the reduced statistics too,
so that samplers are compared and not ways to write a likelihood.
"""

from dataclasses import dataclass
from math import factorial
from pathlib import Path

import numpy as np
import pandas as pd
from rigs.hall import gravity_likelihood
from scipy.interpolate import make_interp_spline

from bayesfric.analysis import Analysis
from bayesfric.inference.cosines import MODES
from bayesfric.inference.model import Model
from bayesfric.physics.friction import REFERENCE_WRAP_ANGLE_DEG
from bayesfric.recording import read_recording
from bayesfric.recording.tables import Gravity, Recording
from bayesfric.rigs.gravity_board.hall_events import LOG_RHO_SPAN
from bayesfric.rigs.gravity_board.measurements import TrialMeasurements, event_table
from bayesfric.rigs.gravity_board.places import TrialPlaces
from bayesfric.rigs.gravity_board.screening import screen_trials

ROOT = Path(__file__).resolve().parents[2]
RECORDING = ROOT / "data" / "recordings" / "synthetic-paper"
NOISE = {"sigma_x": np.array([5e-5]), "sigma_t": np.array([1e-5])}  # behind stated errors
FEW_SETUPS = 5


@dataclass(frozen=True)
class Problem:
    """A posterior of the gravity board.

    Parameters
    ----------
    sizes : tuple of str
        Pulley sizes that enter.
    events : bool
        Whether trials enter by their events, or by an acceleration each.
    setups : int or None
        How many assemblies enter; None for all.
    """

    sizes: tuple[str, ...]
    events: bool
    setups: int | None = None


ALL = ("small", "medium", "large")
PROBLEMS = {
    "trial-medium": Problem(("medium",), events=False),
    "event-medium": Problem(("medium",), events=True),
    "trial-all": Problem(ALL, events=False),
    "event-all": Problem(ALL, events=True),
    "trial-five-setups": Problem(("medium",), events=False, setups=FEW_SETUPS),
}


def gravity_of(problem: Problem, recording: Recording) -> Gravity:
    """Return the trials that enter."""
    screened = screen_trials(recording.gravity, recording.rig).gravity
    trials = screened.trials[screened.trials["pulley_size"].isin(problem.sizes)]
    if problem.setups is not None:
        trials = trials[trials["setup"].isin(trials["setup"].unique()[: problem.setups])]
    trials = trials.reset_index(drop=True)
    events = screened.events[screened.events["trial"].isin(trials["trial"])]
    events = events.reset_index(drop=True)
    if problem.events:
        return Gravity(trials, events)
    seen = Gravity(trials, events)
    measured = TrialMeasurements(seen, event_table(seen, recording.rig), Analysis())
    acceleration = measured.at(NOISE).acceleration()
    trials["acceleration_m_s2"] = acceleration.mean[0]
    trials["acceleration_sd_m_s2"] = np.sqrt(acceleration.variance[0])
    return Gravity(trials, events.iloc[:0])


def model_of(problem: Problem) -> tuple[Model, dict[str, np.ndarray]]:
    """Return a posterior, and its arrays for other samplers."""
    recording = read_recording(RECORDING)
    gravity = gravity_of(problem, recording)
    model = Model([gravity_likelihood(gravity, recording.rig, Analysis())])
    return model, arrays_of(model, gravity, recording)


def arrays_of(model: Model, gravity: Gravity, recording: Recording) -> dict[str, np.ndarray]:
    """Return what :mod:`benchmark.jax_density` needs of a posterior."""
    places = TrialPlaces(gravity, recording.rig)
    condition = places.condition
    mass, drive = condition.total_mass_kg, condition.drive_force_n
    difference = np.asarray(condition.mass_drive_kg) - np.asarray(condition.mass_load_kg)
    arrays = {
        "sizes": np.array(places.size.sizes),
        "names": np.array(model.names),
        "family": np.array([parameter.prior.family for parameter in model.parameters]),
        "scale": np.array([_scale(parameter.prior) for parameter in model.parameters]),
        "size": places.size.of_trial,
        "pulleys": np.asarray(condition.n_pulleys, dtype=float),
        "wrap": np.asarray(condition.wrap_angle_deg) - REFERENCE_WRAP_ANGLE_DEG,
        # T = still + feedback × friction
        "still": 0.5 * mass * np.asarray(condition.gravity_m_s2) - 0.5 * difference * drive / mass,
        "feedback": 0.5 * difference / mass,
        "mass": mass,
        "drive": drive,
        "setup": pd.factorize(gravity.trials["setup"])[0],
    }
    if not len(gravity.events):
        stated = gravity.trials
        return arrays | {
            "acceleration": stated["acceleration_m_s2"].to_numpy(),
            "acceleration_sd": stated["acceleration_sd_m_s2"].to_numpy(),
        }
    table = places.table.with_first_speed(Analysis().priors.first_speed.scale)
    spline, basis = _reduced(table)
    knots = np.unique(spline.t[spline.k : -spline.k])
    powers = range(spline.k, -1, -1)  # a polynomial a piece, for Horner's scheme
    pieces = [spline(knots[:-1], nu=power) / factorial(power) for power in powers]
    return arrays | {
        "knots": knots[:-1],
        "pieces": np.stack(pieces),
        "end": knots[-1:],
        "basis": basis,
        "degrees_of_freedom": table.degrees_of_freedom,
        "constant": table.constant,
        "origin": table.origin,
        "typical_speed": np.array(table.typical_speed),
        "tick_variance": np.array(table.tick_variance),
        "extent": np.array(places.travel_m[places.with_events].max()),
        "modes": np.array(MODES),
    }


def _reduced(table):
    """Return a spline over log ρ of a few coefficients, and their singular vectors, (1 + L, R N).

    One table for all noises suits a compiler better than an interval of them at a time.
    """
    log_ratio = np.linspace(-LOG_RHO_SPAN, LOG_RHO_SPAN, 149)
    rows = np.stack([table.statistics(np.array([ratio]))[0] for ratio in log_ratio])
    rows[:, -1] *= -0.5  # of the determinant, as it stands in the log density
    rows = rows.reshape(log_ratio.size, -1)
    unit = np.abs(rows).mean(axis=0)
    unit[unit == 0] = 1.0
    rows /= unit
    centre = rows.mean(axis=0)
    left, singular, right = np.linalg.svd(rows - centre, full_matrices=False)
    kept = singular > 1e-9 * singular[0]
    spline = make_interp_spline(log_ratio, left[:, kept], k=7)
    return spline, np.vstack([centre, singular[kept, None] * right[kept]]) * unit


def _scale(prior) -> np.ndarray:
    """Return the two numbers of a prior."""
    if prior.family == "half-normal":
        return np.array([prior.scale, 0.0])
    if prior.family == "normal":
        return np.array([prior.sd, prior.mean])
    assert prior.family == "log-normal", prior.family
    return np.array([prior.sd_log, np.log(prior.median)])

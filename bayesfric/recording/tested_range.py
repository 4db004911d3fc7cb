"""Notes on conditions outside those that the paper tested; never an error.

References
----------
M. Miyasaka, J. Matheson, A. Lewis, B. Hannaford, "Measurement of the Cable-Pulley
Coulomb and Viscous Friction for a Cable-Driven Surgical Robotic System", IROS 2015,
Table II.
"""

from collections.abc import Iterator

import numpy as np
import pandas as pd

from bayesfric.errors import first_of
from bayesfric.recording.tables import Gravity, Recording

SPEED_M_S = 1.3
TENSION_N = 33.0
PULLEYS = 19
INDIVIDUAL_WRAP_DEG = (15.0, 180.0)
AVERAGE_WRAP_DEG = (45.0, 150.0)
NAMED = 5
PULLEYS_ARE = ("pulley_size", "n_pulleys", "wrap_angle_deg")  # needed for Table II
WINDOW = 4  # intervals for a speed, so that one odd interval does not matter


def notes_on_range(recording: Recording) -> tuple[str, ...]:
    """Return a sentence for each table on the bounds of Table II that it exceeds, and where."""
    notes: list[str] = []
    g = recording.rig.gravity_m_s2
    if recording.gravity is not None:
        trials = recording.gravity.trials
        # The nominal tension of a moving trial is lower than this, the tension at rest.
        tension = (trials["mass_drive_kg"] + trials["mass_load_kg"]) * g / 2
        fastest = trials["trial"].map(_top_speeds(recording.gravity))
        notes += _notes(trials.assign(tension_n=tension, velocity_m_s=fastest), "trial")
    if recording.motor is not None:
        runs = recording.motor.runs
        notes += _notes(runs.assign(tension_n=runs["hanging_mass_kg"] * g), "run")
    steady = recording.steady
    over_pulleys = steady is not None and any(column in steady for column in PULLEYS_ARE)
    if steady is not None and over_pulleys and not recording.rig.rotary:
        notes += _notes(steady, "run")
    return tuple(notes)


def _notes(table: pd.DataFrame, key: str) -> Iterator[str]:
    passed = [
        f"{what} ({key} {first_of(table.loc[outside, key].tolist(), NAMED)})"
        for what, outside in _outside(table)
        if outside.any()
    ]
    if passed:
        yield f"outside the paper's Table II: {'; '.join(passed)}"


def _outside(table: pd.DataFrame) -> Iterator[tuple[str, "pd.Series[bool]"]]:
    if "velocity_m_s" in table:
        yield f"|v| at most {SPEED_M_S} m/s", table["velocity_m_s"].abs() > SPEED_M_S
    if "tension_n" in table:
        yield f"tension at most {TENSION_N:g} N", table["tension_n"] > TENSION_N
    if "n_pulleys" in table:
        yield f"at most {PULLEYS} pulleys", table["n_pulleys"] > PULLEYS
    if "wrap_angle_deg" in table:
        wrap = table["wrap_angle_deg"]
        low, high = INDIVIDUAL_WRAP_DEG
        yield f"individual wrap angle {low:g} to {high:g} deg", ~wrap.between(low, high)
        low, high = AVERAGE_WRAP_DEG
        yield f"average wrap angle {low:g} to {high:g} deg", ~wrap.between(low, high)


def _top_speeds(gravity: Gravity) -> "pd.Series[float]":
    """Return the highest mean speed over a few Hall intervals of each trial [m/s]."""
    events = gravity.events
    travel = events["displacement_m"].to_numpy(float)
    time = events["time_s"].to_numpy(float)
    trial, ids = pd.factorize(events["trial"])
    sensor, _ = pd.factorize(events["sensor"])
    # Events are sorted, so a train ends if the next row belongs to another one.
    ends = (trial[1:] != trial[:-1]) | (sensor[1:] != sensor[:-1])
    train = np.concatenate([[0], np.cumsum(ends)])[: len(trial)]
    within = train[WINDOW:] == train[:-WINDOW]
    speed = (travel[WINDOW:] - travel[:-WINDOW]) / (time[WINDOW:] - time[:-WINDOW])
    most = pd.Series(speed[within], dtype=np.float64).groupby(train[WINDOW:][within]).max()
    of_train = ids[trial[np.searchsorted(train, most.index)]]
    return most.groupby(of_train).max()

"""The small recordings of the fingerprint: ``PYTHONPATH=tests python -m fingerprint.recordings``.

They are kept as files, so that the numbers of a likelihood or of a diagnosis do not move with a
simulator. Making them anew moves all parts but ``physics``, ``simulators`` and ``margins``.
"""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np

import bayesfric as bf
from bayesfric.recording.tables import Axis, Gravity, Motor
from bayesfric.recording.writing import write_recording
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import Truth, simulate_recording

FOLDER = Path(__file__).parent / "recordings"
BOARD = Protocol({(9, 85.0): 2, (15, 50.0): 1}, (6.0, 28.0), (6.0, 28.0), 2)
TRUTH = Truth(wander=0.004, push=0.02, omega_intercept=0.03, omega_intercept_motor=0.03)


def gravity() -> bf.Recording:
    """Two sizes; a sensor that is missing, events that were missed, a rest, trials of role test."""
    made = simulate_recording(
        BOARD, seed=47, rigs=("gravity",), truth=TRUTH, effects={"viscous": 0.2}, name="gravity"
    )
    trials, events = made.gravity.trials, made.gravity.events
    trials = trials[trials["pulley_size"] != "large"].reset_index(drop=True)
    names = list(trials["trial"])
    events = events[events["trial"].isin(names)]
    one_sensor, missed, at_rest, tested = names[3], names[8], names[12], [names[5], names[17]]
    events = events[~((events["trial"] == one_sensor) & (events["sensor"] == "load"))]
    events = events[events["trial"] != at_rest]
    mine = np.flatnonzero((events["trial"] == missed) & (events["sensor"] == "drive"))
    lost = mine[20]
    # Who writes down events by counting them gives the later ones a place too near.
    events = events.reset_index(drop=True)
    places = events["displacement_m"].to_numpy().copy()
    places[mine[21:]] = places[mine[20:-1]]
    events = events.assign(displacement_m=places).drop(index=lost).reset_index(drop=True)
    trials = trials.assign(
        role=np.where(trials["trial"].isin(tested), "test", "calibrate"),
        did_not_move=np.where(trials["trial"] == at_rest, "true", "false"),
    )
    # At rest the drive is close to what friction holds.
    slower = trials["mass_load_kg"] + 0.4 * (trials["mass_drive_kg"] - trials["mass_load_kg"])
    trials["mass_drive_kg"] = trials["mass_drive_kg"].where(
        trials["trial"] != at_rest, slower.round(4)
    )
    return replace(made, gravity=Gravity(trials, events))


def motor() -> bf.Recording:
    """Every ninth run, some of them lowering the weight, beside a short idle curve."""
    made = simulate_recording(
        BOARD, seed=48, rigs=("motor",), truth=TRUTH, effects={"viscous": 0.2}, name="motor"
    )
    runs = made.motor.runs.iloc[::9].reset_index(drop=True)
    return replace(made, motor=Motor(runs, made.motor.idle.iloc[::6].reset_index(drop=True)))


def points() -> bf.Recording:
    """Every second point, a third of them without a stated error."""
    made = simulate_recording("points", seed=49, effects={"viscous": 0.2}, name="points")
    table = made.steady.iloc[::2].reset_index(drop=True)
    stated = np.arange(len(table)) % 3 != 0
    return replace(made, steady=table.assign(friction_sd_n=table["friction_sd_n"].where(stated)))


def axis() -> bf.Recording:
    """Four runs of two seconds."""
    made = simulate_recording("axis", seed=50, effects={"viscous": 0.2}, name="axis")
    runs, samples = made.axis.runs.iloc[:4], made.axis.samples
    samples = samples[samples["run"].isin(runs["run"]) & (samples["time_s"] < 2.0)]
    return replace(made, axis=Axis(runs, samples.reset_index(drop=True)))


if __name__ == "__main__":
    for make in (gravity, motor, points, axis):
        folder = FOLDER / make.__name__
        shutil.rmtree(folder, ignore_errors=True)
        write_recording(make(), folder)

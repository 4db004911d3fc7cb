"""What a recording of many trials costs: reading, reduction, and a likelihood.

The trials of the bundled recording again and again, under new names and in the same assemblies.
"""

import subprocess
import sys
import tempfile
import time
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
from benchmark.compare import within
from benchmark.memory import peak_mib
from benchmark.problems import RECORDING
from rigs.hall import gravity_likelihood

from bayesfric.analysis import Analysis
from bayesfric.diagnosis import diagnose
from bayesfric.errors import InputError
from bayesfric.inference.model import Model
from bayesfric.recording import read_recording, write_recording
from bayesfric.recording.tables import Gravity
from bayesfric.rigs.gravity_board.screening import screen_trials
from bayesfric.simulate import simulate_recording

TRIALS = (200, 2_000, 20_000, 50_000)
POINTS = 40  # at which the likelihood is evaluated
SLOPE, TIMES = 1.1, 20.0
READ_S, READ_MIB = 5.0, 1024
SAMPLES, SAMPLES_S = 200_000, 20.0  # of a joint's log, that is diagnosed
JITTER = 0.003  # of the force's spread, so that no run is a copy of another
REFUSED = 8_500  # trials, of a million events
REFUSE_S, REFUSE_MIB = 20.0, 1024
SEED = 1


def repeated(recording, trials):
    """Return a recording of so many trials, which are those of another again and again."""
    gravity = screen_trials(recording.gravity, recording.rig).gravity
    rounds = -(-trials // len(gravity.trials))
    tables, events = [], []
    for number in range(rounds):
        table = gravity.trials.copy()
        table["trial"] += f"-{number}"
        event = gravity.events.copy()
        event["trial"] = event["trial"].astype(str) + f"-{number}"
        event["time_s"] *= 1 + 1e-6 * number  # an exact copy would count once
        tables.append(table)
        events.append(event)
    table = pd.concat(tables, ignore_index=True)[:trials]
    table["order"] = np.arange(1, trials + 1)
    event = pd.concat(events, ignore_index=True)
    event = event[event["trial"].isin(table["trial"])].reset_index(drop=True)
    return replace(recording, gravity=Gravity(table, event), motor=None)


def joints_log(samples):
    """Return an axis of so many samples: the runs of a simulated one again and again."""
    recording = simulate_recording("axis", seed=SEED)
    axis, rng = recording.axis, np.random.default_rng(SEED)
    rounds = -(-samples // len(axis.samples))
    runs = pd.concat(
        [axis.runs.assign(run=axis.runs["run"] + f"-{number}") for number in range(rounds)],
        ignore_index=True,
    )
    tables = []
    for number in range(rounds):
        table = axis.samples.assign(run=axis.samples["run"].astype(str) + f"-{number}")
        spread = JITTER * table["force_n"].std()
        tables.append(table.assign(force_n=table["force_n"] + spread * rng.normal(size=len(table))))
    runs["order"] = np.arange(1, len(runs) + 1)
    whole = replace(axis, runs=runs, samples=pd.concat(tables, ignore_index=True))
    return replace(recording, axis=whole)


def targets():
    """Return a row a target, and the figures behind them."""
    recording = read_recording(RECORDING)
    seconds = {}
    for trials in TRIALS:
        board = repeated(recording, trials)
        began = time.process_time()
        model = Model([gravity_likelihood(board.gravity, board.rig, Analysis())])
        theta = model.draw_prior(POINTS, np.random.default_rng(SEED))
        model.log_likelihood(theta)  # which tabulates what all likelihoods share
        reduced = time.process_time()
        model.log_likelihood(theta)
        seconds[trials] = {"reduce": reduced - began, "likelihood": time.process_time() - reduced}
    with tempfile.TemporaryDirectory() as folder:
        for trials in TRIALS:
            write_recording(repeated(recording, trials), Path(folder) / str(trials))
            seconds[trials] |= _read(Path(folder) / str(trials))
        wrong = Path(folder) / "wrong"
        write_recording(repeated(recording, REFUSED), wrong)
        events = wrong / "gravity_events.csv"
        events.write_bytes(events.read_bytes().replace(b",drive,", b",drove,"))
        refused = _read(wrong)
    log = joints_log(SAMPLES)
    began = time.process_time()
    diagnose(log, Analysis(seed=SEED))
    diagnosed = time.process_time() - began
    first, last = seconds[TRIALS[1]], seconds[TRIALS[-1]]
    ratio = TRIALS[-1] / TRIALS[1]  # from 2,000 on, so that no constant part flatters
    whole = [run["read"] + run["reduce"] for run in (first, last)]
    slope = float(np.log(whole[1] / whole[0]) / np.log(ratio))
    times = last["likelihood"] / seconds[TRIALS[0]]["likelihood"]
    rows = [
        within("reading and reduction, slope in log-log", slope, SLOPE),
        within("a likelihood at 50,000 trials, over one at 200", times, TIMES),
        within("diagnosing a joint's log of 200,000 samples, seconds", diagnosed, SAMPLES_S),
        within("reading 6 million events, seconds", last["read"], READ_S),
        within("reading 6 million events, MiB", last["read_mib"], READ_MIB),
        within("refusing a million events, seconds", refused["read"], REFUSE_S),
        within("refusing a million events, MiB", refused["read_mib"], REFUSE_MIB),
    ]
    figures = {str(trials): timed for trials, timed in seconds.items()}
    return rows, figures | {"refused": refused, "joint's log": {"diagnose": diagnosed}}


def _read(folder):
    """Read a recording in a process of its own."""
    command = [sys.executable, "-m", "benchmark.sizes", str(folder)]
    said = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    read, mib = map(float, said.split())
    return {"read": read, "read_mib": mib}


if __name__ == "__main__":
    start = time.process_time()
    with suppress(InputError):
        read_recording(Path(sys.argv[1]))
    sys.stdout.write(f"{time.process_time() - start} {peak_mib()}\n")

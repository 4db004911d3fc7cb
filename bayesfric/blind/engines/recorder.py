"""The recorder: magnets, clock and currents with their noise, as a recording."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.random import Generator

from bayesfric.blind.engines.boards import (
    CAPSTAN_M,
    SPACING_M,
    TORQUE_CONSTANT,
    motor_currents,
    passages_of,
)
from bayesfric.blind.engines.design import TRAVEL_M, Bench, Trials
from bayesfric.blind.engines.law import GRAVITY, SIZES, Nature
from bayesfric.blind.engines.measuring_forms import MAGNETS
from bayesfric.blind.engines.motion import Board, Motion, times_at
from bayesfric.blind.engines.state import Array, BoardState, ImposedEffect
from bayesfric.recording import Recording, read_recording

Table = dict[str, list[str]]  # cells by column, as they are printed
CLOCK_S = 4e-6
LEAST_EVENTS = 5  # of a sensor in a trial, that the format asks for
IDLE_SPEEDS_M_S = np.repeat(np.round(0.05 * np.arange(1, 27), 2), 3)


@dataclass
class Train:
    """The events of one trial and sensor, counted by the recorder.

    Parameters
    ----------
    trial : int
        Place of the trial.
    sensor : str
        ``drive`` or ``load``.
    time_s : ndarray
        What the clock said.
    """

    trial: int
    sensor: str
    time_s: Array


def event_trains(
    board: Board,
    motion: Motion,
    effects: Sequence[ImposedEffect],
    phases_m: dict[bool, Array],
    clock_start_s: Array,
    nature: Nature | None,
    rng: Generator,
) -> list[Train]:
    """Return what each sensor wrote down in each trial.

    Parameters
    ----------
    board, motion : Board, Motion
        The trials and how they run.
    effects : sequence of ImposedEffect
        Those on readings and on the clock act.
    phases_m : dict
        By sensor, true for the load end's: travel to the first magnet, (trials, 1) [m].
    clock_start_s : ndarray, shape (trials, 1)
        What the clock says at the release.
    nature : Nature or None
        Whose noise there is; None for none, and a clock without ticks.
    rng : Generator
        Of the noise.
    """
    trains = []
    for at_load, phases in sorted(phases_m.items()):
        at, places = passages_of(board, motion, phases, at_load)
        for effect in effects:
            if effect.form.acts == "reading":
                places = places + np.nan_to_num(effect(at))
        if nature is not None:
            places = places + nature.sigma_x * rng.standard_normal(places.shape)
        time, _ = times_at(motion, np.maximum(places, 1e-9))
        time = time + clock_start_s
        for effect in effects:
            if effect.form.acts == "clock":
                time = time * (1 + effect(at))
        if nature is not None:
            time = time + nature.sigma_t * rng.standard_normal(places.shape)
        for trial, row in enumerate(time):
            seen = row[np.isfinite(row)]
            trains.append(Train(trial, "load" if at_load else "drive", seen))
    return trains


def gravity_tables(
    trials: Trials, trains: Sequence[Train], ticks: bool
) -> tuple[dict[str, Table], list[int]]:
    """Return the gravity board's tables by file, and the trials too short to be written down."""
    ids = [f"g{i + 1:04d}" for i in range(len(trials))]
    events: Table = {"trial": [], "sensor": [], "displacement_m": [], "time_s": []}
    for train in sorted(trains, key=lambda train: (train.trial, train.sensor)):
        time = np.round(train.time_s / CLOCK_S) * CLOCK_S if ticks else train.time_s
        time = time[np.concatenate([[True], np.diff(time) > 0])] if time.size else time
        if time.size < LEAST_EVENTS:
            continue
        events["trial"] += [ids[train.trial]] * time.size
        events["sensor"] += [train.sensor] * time.size
        events["displacement_m"] += [f"{i * SPACING_M:.4f}" for i in range(time.size)]
        events["time_s"] += [f"{t:.6f}" if ticks else _number(t) for t in time.tolist()]
    written = set(events["trial"])
    kept = [i for i in range(len(trials)) if ids[i] in written]
    rows: Table = {
        "trial": [ids[i] for i in kept],
        "order": [str(i + 1) for i in kept],
        "setup": [f"s{trials.setup[i] + 1:03d}" for i in kept],
        "pulley_size": [SIZES[trials.size[i]] for i in kept],
        "n_pulleys": [_number(trials.n_pulleys[i]) for i in kept],
        "wrap_angle_deg": [_number(trials.wrap_angle_deg[i]) for i in kept],
        "mass_drive_kg": [_number(trials.drive_kg[i]) for i in kept],
        "mass_load_kg": [_number(trials.load_kg[i]) for i in kept],
        "drive_end": ["left" if trials.drive_left[i] else "right" for i in kept],
    }
    lost = sorted(set(range(len(trials))) - set(kept))
    return {"gravity_trials.csv": rows, "gravity_events.csv": events}, lost


def motor_tables(
    bench: Bench,
    state: BoardState,
    effects: Sequence[ImposedEffect],
    factor: Array,
    nature: Nature,
    rng: Generator | None,
) -> dict[str, Table]:
    """Return the motor board's tables by file; `rng` is of the noise, None for none."""
    read, load = motor_currents(state, effects, factor)
    current = read[:, 0] + np.polynomial.polynomial.polyval(bench.speed_m_s, nature.idle)
    idle = np.polynomial.polynomial.polyval(IDLE_SPEEDS_M_S, nature.idle)
    if rng is not None:
        sd = np.hypot(nature.sigma_current, nature.load_noise * load[:, 0])
        current = np.round(current + sd * rng.standard_normal(current.size), 6)
        idle = np.round(idle + nature.sigma_current * rng.standard_normal(idle.size), 6)
    runs: Table = {
        "run": [f"m{i + 1:04d}" for i in range(len(bench))],
        "order": [str(i + 1) for i in range(len(bench))],
        "setup": [f"m{setup + 1:03d}" for setup in bench.setup],
        "pulley_size": [SIZES[size] for size in bench.size],
        "n_pulleys": [_number(value) for value in bench.n_pulleys],
        "wrap_angle_deg": [_number(value) for value in bench.wrap_angle_deg],
        "hanging_mass_kg": [_number(value) for value in bench.weight_kg],
        "velocity_m_s": [_number(value) for value in bench.speed_m_s],
        "current_a": [_number(value) for value in current],
    }
    idle_rows: Table = {
        "velocity_m_s": [_number(value) for value in IDLE_SPEEDS_M_S],
        "current_a": [_number(value) for value in idle],
    }
    return {"motor_runs.csv": runs, "motor_idle.csv": idle_rows}


def _number(value: float) -> str:
    return repr(float(value)).removesuffix(".0")


def recorded(tables: dict[str, Table]) -> Recording:
    """Return the tables as a recording that has been written and read, fingerprint and all."""
    rig: dict[str, Any] = {
        "gravity_m_s2": GRAVITY,
        "hall_spacing_m": SPACING_M,
        "magnets_per_revolution": MAGNETS,
        "timer_resolution_s": CLOCK_S,
        "limits": {"travel_m": [0.0, TRAVEL_M]},
    }
    if "motor_runs.csv" in tables:
        rig["motor_torque_constant_n_m_per_a"] = TORQUE_CONSTANT
        rig["capstan_radius_m"] = CAPSTAN_M
    package = {
        "name": "blind-case",
        "title": "Synthetic pulley-board recording with something withheld, or nothing",
        "sources": [{"title": "Simulated; no board was measured"}],
        "licenses": [{"name": "CC0-1.0"}],
        "rig": rig,
        "resources": [
            {"name": file.removesuffix(".csv").replace("_", "-"), "path": file} for file in tables
        ],
    }
    with TemporaryDirectory() as folder:
        (Path(folder) / "datapackage.json").write_text(json.dumps(package), encoding="utf-8")
        for file, table in tables.items():
            lines = [",".join(table), *map(",".join, zip(*table.values(), strict=True))]
            text = "".join(f"{line}\n" for line in lines)
            (Path(folder) / file).write_bytes(text.encode())
        return read_recording(folder)

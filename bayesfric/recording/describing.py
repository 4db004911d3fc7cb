"""The content of a recording, in a few labelled lines of text."""

import numpy as np
import pandas as pd

from bayesfric.recording.frames import did_not_move, stands_in
from bayesfric.recording.tables import Gravity, Motor, Recording


def describe_recording(recording: Recording) -> tuple[tuple[str, str], ...]:
    """Summarise a recording.

    Parameters
    ----------
    recording : Recording
        The recording, as read.

    Returns
    -------
    tuple of (str, str)
        Label and text: the name, the title, one pair for each kind of table and, below a
        board, one for each of its pulley sizes.
    """
    lines = [("name", recording.name), ("title", recording.title)]
    if recording.created is not None:
        lines.append(("created", recording.created))
    lines.append(("gravity", f"{recording.rig.gravity_m_s2:g} m/s²"))
    if recording.gravity is not None:
        lines += _gravity(recording.gravity, recording.rig.gravity_m_s2)
    if recording.motor is not None:
        lines += _motor(recording.motor, recording.rig.gravity_m_s2)
    if recording.steady is not None:
        force = "N·m" if recording.rig.rotary else "N"
        friction = _range(recording.steady["friction_n"], force)
        text = f"{_count(len(recording.steady), 'point')}, {friction}"
        for column, label, unit in (
            ("tension_n", "tension", force),
            ("velocity_m_s", "v", "rad/s" if recording.rig.rotary else "m/s"),
        ):
            if column in recording.steady:
                text += f", {label} {_range(recording.steady[column], unit)}"
        lines.append(("steady friction", text))
    if recording.axis is not None:
        runs, samples = recording.axis.runs, recording.axis.samples
        text = f"{_count(len(runs), 'run')}, {_count(len(samples), 'sample')}"
        covariates = [str(name) for name in runs if name not in ("run", "order", "setup", "role")]
        if covariates:
            text += f", with {', '.join(covariates)}"
        if "joint" in samples:
            text += f", of {_count(samples['joint'].nunique(), 'joint')}"
        lines += [("single axis", text), ("  log", _log(samples, recording.rig.rotary))]
    if recording.sha256:  # none before it is written
        lines.append(("sha256", recording.sha256))
    return tuple(lines)


def _log(samples: pd.DataFrame, rotary: bool) -> str:
    """Return duration, travel and force of a log, which reveal a wrong unit."""
    keys = [name for name in ("run", "joint") if name in samples]
    runs = samples.groupby(keys, sort=False)
    longest = (runs["time_s"].last() - runs["time_s"].first()).max()
    travel = (runs["position_m"].max() - runs["position_m"].min()).max()
    way = f"{travel:.3g} rad ({np.rad2deg(travel):,.1f}°)" if rotary else f"{travel:.3g} m"
    if "force_n" in samples:
        drive = f"force {_range(samples['force_n'], 'N·m' if rotary else 'N')}"
    else:
        drive = f"command {_range(samples['command_m'], 'rad' if rotary else 'm')}"
    interval = runs["time_s"].diff().median()
    pace = "" if np.isnan(interval) else f" a sample every {interval:.3g} s,"
    return f"up to {longest:.3g} s and {way} a run,{pace} {drive}"


def _gravity(gravity: Gravity, g: float) -> list[tuple[str, str]]:
    trials, events = gravity.trials, gravity.events
    text = f"{_count(len(trials), 'trial')}, {_count(len(events), 'event')}"
    still = did_not_move(trials)
    without = int((~stands_in(trials["trial"], events["trial"]) & ~still).sum())
    if still.any():
        text += f", {still.sum()} that did not move"
    if without:
        text += f", {without} with an acceleration only"
    lines = [("gravity board", text)]
    for size, group in trials.groupby("pulley_size", sort=False):
        tension = (group["mass_drive_kg"] + group["mass_load_kg"]) * g / 2
        sensors = events.loc[events["trial"].isin(group["trial"]), "sensor"].unique()
        parts = _board(group, "trial", tension)
        if len(sensors):
            parts += f", sensors {' and '.join(sensors)}"
        lines.append((f"  {size}", parts))
    return lines


def _motor(motor: Motor, g: float) -> list[tuple[str, str]]:
    runs = motor.runs
    text = f"{_count(len(runs), 'run')}, {_count(len(motor.idle), 'idle point')}"
    lines = [("motor board", text)]
    for size, group in runs.groupby("pulley_size", sort=False):
        speed = _range(group["velocity_m_s"], "m/s")
        parts = _board(group, "run", group["hanging_mass_kg"] * g)
        lines.append((f"  {size}", f"{parts}, v {speed}"))
    return lines


def _board(group: pd.DataFrame, row: str, tension_n: pd.Series) -> str:
    setups = _count(group["setup"].nunique(), "setup")
    counts = ", ".join(str(count) for count in sorted(group["n_pulleys"].unique()))
    angles = ", ".join(f"{angle:g}" for angle in sorted(group["wrap_angle_deg"].unique()))
    return (
        f"{_count(len(group), row)} on {setups}, n = {counts}, "
        f"wrap {angles} deg, tension {_range(tension_n, 'N')}"
    )


def _range(values: pd.Series, unit: str) -> str:
    low, high = f"{values.min():.3g}", f"{values.max():.3g}"
    return f"{low} {unit}" if low == high else f"{low} to {high} {unit}"


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" + ("" if number == 1 else "s")

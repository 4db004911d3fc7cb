"""Rules for a log of driven joints that involve more than one cell."""

from collections.abc import Mapping

import numpy as np
import pandas as pd

from bayesfric.errors import Fault, near
from bayesfric.recording.cells import Table
from bayesfric.recording.package import fault_of_key
from bayesfric.recording.robot_file import faults_of_joints
from bayesfric.recording.tables import RigConstants

SAMPLES = "axis_samples.csv"


def joint_of_run(samples: Table) -> list[str]:
    """Return the columns that identify a clock: the run, and the joint if there are several."""
    return [name for name in ("run", "joint") if samples.has(name)]


def number_of_clock(samples: Table) -> "pd.Series[int]":
    """Return the number of the run and joint of each sample, shape (N,)."""
    keys = joint_of_run(samples)
    return samples.frame.groupby(keys, sort=False, observed=True).ngroup()


def faults_of_samples(tables: Mapping[str, Table], rig: RigConstants) -> list[Fault]:
    """Return the faults of samples that contradict each other or the machine.

    Parameters
    ----------
    tables : mapping of str to Table
        Canonical file name to table; only those that could be parsed.
    rig : RigConstants
        The machine.
    """
    faults = _mass(rig)
    if runs := tables.get("axis_runs.csv"):
        for name in (str(name) for name in runs.frame if str(name).endswith("_kg")):
            wrong = runs.frame[name] < 0
            faults += runs.faults_where(wrong, name, "a mass that the run carries, 0 at least")
    samples = tables.get(SAMPLES)
    if samples is None:
        return faults
    faults += _no_force(samples) + _command_in_rad(samples, rig)
    if samples.has("run"):
        for column in ("force_time_s", "command_time_s"):
            faults += _backwards(samples, column)
    if rig.robot is not None:
        joints = samples.frame["joint"].dropna().unique() if samples.has("joint") else None
        faults += faults_of_joints(rig.robot, None if joints is None else [*map(str, joints)])
    return faults


def _mass(rig: RigConstants) -> list[Fault]:
    if rig.mass_sd_kg is None or (rig.moving_mass_kg or 0.0) >= rig.mass_sd_kg:
        return []
    if rig.moving_mass_kg is None:
        return [fault_of_key("rig.moving_mass_kg", "this key, whose error mass_sd_kg is")]
    expected = f"at most moving_mass_kg, {rig.moving_mass_kg:g} (is it in grams, or percent?)"
    return [fault_of_key("rig.mass_sd_kg", expected, f"{rig.mass_sd_kg:g}")]


def _no_force(samples: Table) -> list[Fault]:
    written = samples.text.cells.columns
    if samples.has("force_n") or samples.has("command_m") or "force_n" in written:
        return []
    rule = next(column for column in samples.format.columns if column.name == "force_n")
    expected = (
        f"this column, each cell {rule.expected}{near('force_n', map(str, written))}, or command_m "
        "where only a commanded position was logged"
    )
    return [Fault(samples.text.file, expected, row=1, column="force_n")]


def _command_in_rad(samples: Table, rig: RigConstants) -> list[Fault]:
    if rig.rotary or samples.text.written.get("command_m") != "command_rad":
        return []
    expected = "command_m of an axis that slides, or true of rig.rotary in datapackage.json"
    return [Fault(samples.text.file, expected, row=1, column="command_rad")]


def _backwards(samples: Table, column: str) -> list[Fault]:
    """Return the faults of a channel's clock that goes back; equal times mean a held value."""
    if not samples.has(column):
        return []
    clock = samples.frame[column]
    before = clock.groupby(number_of_clock(samples), sort=False).shift()
    expected = f"at least the {column} before it, within a {' and '.join(joint_of_run(samples))}"
    return samples.faults_where(np.asarray(clock < before), column, expected)

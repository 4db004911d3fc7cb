"""Writes a :class:`~bayesfric.recording.tables.Recording` to a folder, atomically."""

import csv
import io
import json
import shutil
import uuid
from collections.abc import Iterable
from dataclasses import fields
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from bayesfric.errors import Fault, InputError, writable
from bayesfric.recording.columns import TABLES, TableFormat
from bayesfric.recording.package import PACKAGE_FILE
from bayesfric.recording.reading import assemble
from bayesfric.recording.spacing import decimals_of
from bayesfric.recording.tables import Recording, RigConstants

# For kinds 3 and 4 on a rotary rig.
ROTARY_UNITS = {"m": "rad", "N": "N·m", "kg": "kg·m²", "m/s": "rad/s"}
ROTARY_TABLES = ("steady_friction.csv", "axis_samples.csv")


def check_free(folder: str | PathLike[str]) -> None:
    """Refuse a path at which no recording can be written, since something exists there.

    Raises
    ------
    InputError
        It is a file, or a folder that is not empty.
    """
    target = Path(folder).resolve()
    if target.exists() and not (target.is_dir() and not any(target.iterdir())):
        raise InputError([Fault(str(folder), "a folder that is empty or does not exist yet")])


def write_recording(recording: Recording, folder: str | PathLike[str]) -> None:
    """Write a recording so that :func:`read_recording` gives it back.

    The same recording gives the same bytes on every platform. It is checked by the
    reader's own rules before anything is written. The folder gets its name only when it
    is complete.

    Parameters
    ----------
    recording : Recording
        Tables with the columns of the format only; ``sha256`` and ``notes`` are not written.
    folder : str or path-like
        A folder that is empty or does not exist.

    Raises
    ------
    InputError
        If the folder is not empty or cannot be written, or the recording breaks a rule
        of the format.
    ValueError
        If a table has a column that the format does not know.
    """
    contents = _contents(recording)
    assemble(contents.__getitem__)
    check_free(folder)
    target = Path(folder).resolve()
    temporary = target.with_name(f".{target.name}.{uuid.uuid4().hex}")
    try:
        with writable(str(folder)):
            temporary.mkdir(parents=True)
            for name, content in contents.items():
                (temporary / name).parent.mkdir(parents=True, exist_ok=True)
                (temporary / name).write_bytes(content)
            if target.exists():  # empty: not every platform renames over a folder
                target.rmdir()
            temporary.rename(target)
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def _contents(recording: Recording) -> dict[str, bytes]:
    """Return bytes by file name, ``datapackage.json`` first."""
    frames: dict[str, pd.DataFrame] = {}
    if recording.gravity is not None:
        frames["gravity_trials.csv"] = recording.gravity.trials
        if not recording.gravity.events.empty:
            frames["gravity_events.csv"] = _printed_events(recording.gravity.events, recording.rig)
    if recording.motor is not None:
        frames["motor_runs.csv"] = recording.motor.runs
        frames["motor_idle.csv"] = recording.motor.idle
    if recording.steady is not None:
        frames["steady_friction.csv"] = recording.steady
    if recording.axis is not None:
        frames["axis_runs.csv"] = recording.axis.runs
        frames["axis_samples.csv"] = recording.axis.samples
    frames |= recording.further
    ordered = {file: _in_order(frame, TABLES[file]) for file, frame in frames.items()}
    package = _package(recording, ordered)
    text = json.dumps(package, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    contents = {PACKAGE_FILE: text.encode()}
    if (robot := recording.rig.robot) is not None:
        contents |= {robot.model: robot.content, **robot.files}
    return contents | {file: _csv(frame) for file, frame in ordered.items()}


def _in_order(frame: pd.DataFrame, table: TableFormat) -> pd.DataFrame:
    names = [name for name in table.names if name in frame]
    others = [str(name) for name in frame.columns if name not in names]
    if others and not table.keeps_covariates:
        raise ValueError(f"{table.file} has no column {', '.join(others)}")
    return frame[names + others]


def _printed_events(events: pd.DataFrame, rig: RigConstants) -> pd.DataFrame:
    """Return displacements with the digits of the spacing, and times with those of the clock."""
    printed = events.copy()
    if rig.hall_spacing_m is not None:
        decimals = min(max(4, _decimals(rig.hall_spacing_m)), 10)
        printed["displacement_m"] = _fixed(events["displacement_m"].to_numpy(), decimals)
    if rig.timer_resolution_s is not None:
        decimals = min(_decimals(rig.timer_resolution_s), 12)
        times = events["time_s"].to_numpy(dtype=float)
        # Times that are finer than the clock keep their digits, so that nothing is lost.
        if np.abs(np.round(times, decimals) - times).max() < 1e-3 * rig.timer_resolution_s:
            printed["time_s"] = _fixed(times, decimals)
    return printed


def _fixed(values: npt.NDArray[np.float64], decimals: int) -> list[str]:
    return [f"{value:.{decimals}f}" for value in values.tolist()]


def _decimals(value: float) -> int:
    """Return the decimal places of the shortest decimal that equals this float."""
    return max(0, decimals_of(repr(value).removesuffix(".0")))


def _csv(frame: pd.DataFrame) -> bytes:
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(frame.columns)
    columns = (_cells(frame[name]) for name in frame)
    writer.writerows(zip(*columns, strict=True))
    return text.getvalue().encode()


def _cells(column: pd.Series) -> Iterable[str]:
    if not pd.api.types.is_float_dtype(column):
        return ["" if pd.isna(cell) else str(cell) for cell in column.tolist()]
    return [
        "" if np.isnan(number) else repr(number).removesuffix(".0") for number in column.tolist()
    ]


def _package(recording: Recording, frames: dict[str, pd.DataFrame]) -> dict[str, Any]:
    package: dict[str, Any] = {"name": recording.name, "title": recording.title}
    if recording.created is not None:
        package["created"] = recording.created
    package |= recording.metadata
    package["rig"] = _rig(recording.rig)
    package["resources"] = [
        _resource(TABLES[file], frame, recording.rig.rotary) for file, frame in frames.items()
    ]
    return package


def _rig(rig: RigConstants) -> dict[str, Any]:
    keys = {entry.name: getattr(rig, entry.name) for entry in fields(rig)}
    keys["pulleys"] = {
        size: {key: value for key, value in vars(pulley).items() if value is not None}
        for size, pulley in rig.pulleys.items()
    }
    keys["limits"] = dict(rig.limits)
    if rig.robot is not None:
        keys["robot"] = {"model": rig.robot.model, "joints": dict(rig.robot.joints)}
    # A zero must be written; since `0.0 == False`, values are not tested with `in`.
    return {
        key: value
        for key, value in keys.items()
        if value is not None and value is not False and value != {}
    }


def _resource(table: TableFormat, frame: pd.DataFrame, rotary: bool) -> dict[str, Any]:
    columns = {column.name: column for column in table.columns}
    schema = []
    for name in frame.columns:
        column = columns.get(name)
        kind = column.kind if column else "number"
        field = {"name": name, "type": kind if kind in ("number", "integer") else "string"}
        if column and column.unit:
            is_rotary = rotary and table.file in ROTARY_TABLES
            field["unit"] = ROTARY_UNITS.get(column.unit, column.unit) if is_rotary else column.unit
        if column:
            field["description"] = column.meaning
        schema.append(field)
    return {
        "name": table.resource,
        "path": table.file,
        "format": "csv",
        "encoding": "utf-8",
        "schema": {"fields": schema},
    }

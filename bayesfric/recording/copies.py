"""Rows and trials that are copies of others: the same measurement under another id.

One measurement that is recorded six times is not six measurements. Trials of the gravity board and
runs of a joint have so many events and samples that two of them are never equal by chance. A point,
or a run of the motor board, has one reading, and rounded readings may repeat by chance. Rows then
count as copies only if their readings agree in more digits than chance explains.
"""

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
import pandas as pd

from bayesfric.arrays import Array
from bayesfric.errors import first_of
from bayesfric.recording.cells import Table
from bayesfric.recording.frames import stands_in
from bayesfric.recording.spacing import decimals_of
from bayesfric.recording.tables import Axis, Gravity, Recording

SPREAD = 1e-3  # least relative difference between genuine repeats
SURE = 4.0  # digits in which copies agree: chance does so once in ten thousand
LEAST_SAMPLES = 5  # samples of a trial and sensor, or of a run, that are never equal by chance
RECENT = 20  # earlier rows of a kind with which a row is compared
NAMED = 10  # ids in a note
OWN = ("trial", "run", "order", "setup", "role")  # columns of the row, not of the measurement
READINGS = {
    "motor_runs.csv": ("run", "current_a"),
    "steady_friction.csv": ("run", "friction_n"),
    "gravity_trials.csv": ("trial", "acceleration_m_s2"),
}
Copies = dict[str, str]
"""Id of each copy to the id of its original, in the order of the file."""


def without_copies(
    recording: Recording, tables: Mapping[str, Table]
) -> tuple[Recording, tuple[str, ...]]:
    """Return a recording without copies of measurements, and notes on what was left out.

    Parameters
    ----------
    recording : Recording
        As read.
    tables : mapping of str to Table
        Tables by canonical file name, as written, since digits count.

    Returns
    -------
    recording : Recording
        The recording without the copies.
    notes : tuple of str
        A sentence for each table, with the ids of copies and of their originals.
    """
    notes: list[str] = []

    def used_once(
        file: str, key: str, copies: Copies, *frames: pd.DataFrame
    ) -> tuple[pd.DataFrame, ...]:
        """Return tables without the rows of copies, which are noted."""
        if not copies:
            return frames
        notes.append(_said(file, key, copies))
        return tuple(frame[~frame[key].isin(copies)].reset_index(drop=True) for frame in frames)

    if (gravity := recording.gravity) is not None:
        file = "gravity_trials.csv"
        same, unlike = _of_trains(gravity)
        notes += _unlike(file, "events", unlike)
        copies = _of_readings(tables, file) | same
        trials, events = used_once(file, "trial", copies, gravity.trials, gravity.events)
        recording = replace(recording, gravity=Gravity(trials, events))
    if (motor := recording.motor) is not None:
        copies = _of_readings(tables, "motor_runs.csv")
        (runs,) = used_once("motor_runs.csv", "run", copies, motor.runs)
        recording = replace(recording, motor=replace(motor, runs=runs))
    if recording.steady is not None:
        copies = _of_readings(tables, "steady_friction.csv")
        (steady,) = used_once("steady_friction.csv", "run", copies, recording.steady)
        recording = replace(recording, steady=steady)
    if (axis := recording.axis) is not None:
        copies, unlike = _of_runs(axis)
        notes += _unlike("axis_runs.csv", "samples", unlike)
        runs, samples = used_once("axis_runs.csv", "run", copies, axis.runs, axis.samples)
        recording = replace(recording, axis=Axis(runs, samples))
    return recording, tuple(notes)


def _said(file: str, what: str, copies: Copies) -> str:
    shown = first_of([f"{copy} of {first}" for copy, first in copies.items()], NAMED)
    copy = "an exact copy" if len(copies) == 1 else "exact copies"
    return f"{file}: {what} {shown}: {copy}, used once"


def _unlike(file: str, what: str, pairs: Copies) -> Iterator[str]:
    if not pairs:
        return
    shown = first_of([f"{other} and {first}" for other, first in pairs.items()], NAMED)
    yield (
        f"{file}: {shown} have the same {what} to the last digit and another condition: is one of "
        "them what was measured?"
    )


def _of_readings(tables: Mapping[str, Table], file: str) -> Copies:
    """Return the rows of a table whose one reading shows that they are copies."""
    table = tables.get(file)
    name, reading = READINGS[file]
    if table is None or not table.has(reading):
        return {}
    frame = table.frame.drop(columns=[column for column in OWN if column in table.frame])
    there = (frame[reading].notna() & ~_has_events(table, tables)).to_numpy()
    kind = frame.groupby([*frame], dropna=False, sort=False, observed=True).ngroup().to_numpy()
    digits = _digits(table.text.cells[reading], frame[reading])
    first = _stretches(np.where(there, kind, -1 - np.arange(kind.size)), digits)
    ids = table.frame[name].astype(str).tolist()
    return {ids[row]: ids[root] for row, root in first.items()}


def _has_events(table: Table, tables: Mapping[str, Table]) -> "pd.Series[bool]":
    """Return which rows have events: the events are then the measurement, not the reading."""
    events = tables.get("gravity_events.csv")
    if events is None or not (events.has("trial") and table.has("trial")):
        return pd.Series(False, index=table.frame.index)
    return stands_in(table.frame["trial"], events.frame["trial"])


def _digits(cells: "pd.Series[str]", values: "pd.Series[float]") -> Array:
    """Return how many equal digits of each reading chance does not explain, shape (N,).

    Repeats that differ by a standard deviation s and are written in steps of δ are equal with
    probability δ / (2 √π s).
    """
    places = np.array([decimals_of(cell) for cell in cells], dtype=np.float64)
    step = 10.0 ** -np.clip(places, -12.0, 15.0)
    spread = 2 * np.sqrt(np.pi) * SPREAD * values.abs().to_numpy()
    agree = np.log10(np.maximum(np.nan_to_num(spread) / step, 1.0))
    return np.asarray(agree, dtype=np.float64)


def _stretches(kind: Sequence[int] | np.ndarray, digits: Array) -> dict[int, int]:
    """Return each row of a stretch that repeats earlier rows in order, with the repeated row."""
    earlier: dict[int, list[int]] = {}
    first: dict[int, int] = {}
    agreed_before: dict[
        int, tuple[float, int]
    ] = {}  # by the earlier row: digits, length of the stretch
    for row, of_row in enumerate(np.asarray(kind).tolist()):
        before = earlier.setdefault(of_row, [])
        now: dict[int, tuple[float, int]] = {}
        for other in before[-RECENT:] + before[:1]:
            agreed, length = agreed_before.get(other - 1, (0.0, 0))
            now[other] = agreed + float(digits[row]), length + 1
        if now:
            other, (agreed, length) = max(now.items(), key=lambda item: item[1][0])
            if agreed >= SURE:
                for back in range(length):
                    root = other - back
                    first.setdefault(row - back, first.get(root, root))
        before.append(row)
        agreed_before = now
    return dict(sorted(first.items()))


def _of_trains(gravity: Gravity) -> tuple[Copies, Copies]:
    """Return trials with the events of an earlier trial: in the same condition, and in another."""
    events, trials = gravity.events, gravity.trials
    if events.empty:
        return {}, {}
    columns = [
        pd.factorize(events["sensor"])[0].astype(np.float64),
        events["displacement_m"].to_numpy(np.float64),
        events["time_s"].to_numpy(np.float64),
    ]
    alike = _alike(events["trial"], columns, clock=2)
    condition = trials.drop(columns=[name for name in OWN if name in trials])
    return _by_condition(alike, trials["trial"], condition)


def _of_runs(axis: Axis) -> tuple[Copies, Copies]:
    """Return runs with the samples of an earlier run: in the same condition, and in another."""
    samples, runs = axis.samples, axis.runs
    names = [name for name in samples if name != "run"]
    columns = [
        pd.factorize(samples[name])[0].astype(np.float64)
        if name == "joint"
        else samples[name].to_numpy(np.float64)
        for name in names
    ]
    in_order = pd.factorize(samples["run"])[0].argsort(kind="stable")
    alike = _alike(
        samples["run"].iloc[in_order],
        [column[in_order] for column in columns],
        clock=names.index("time_s"),
    )
    condition = runs.drop(columns=[name for name in OWN if name in runs])
    return _by_condition(alike, runs["run"], condition)


def _alike(ids: pd.Series, columns: list[Array], clock: int) -> Copies:
    """Return ids of row groups that equal an earlier group, apart from the start of their clocks.

    Parameters
    ----------
    ids : Series of str
        Id of the group of each row; rows of a group are adjacent.
    columns : list of ndarray, shape (N,)
        The measured columns.
    clock : int
        Index of the column that is the time [s].
    """
    codes, names = pd.factorize(ids)
    starts = np.flatnonzero(np.diff(codes, prepend=-1))
    ends = np.append(starts[1:], codes.size)
    lasting = np.round(columns[clock][ends - 1] - columns[clock][starts], 9)
    # Only groups of equal duration and number of rows are compared.
    groups = pd.DataFrame({"size": ends - starts, "lasting": lasting})
    chosen = groups.duplicated(keep=False) & (groups["size"] >= LEAST_SAMPLES)
    copies: Copies = {}
    seen: dict[bytes, str] = {}
    for group in np.flatnonzero(chosen).tolist():
        begin, end = int(starts[group]), int(ends[group])
        name = str(names[codes[begin]])
        times = columns[clock][begin:end]
        since = np.round(times - times[0], 9)
        measured = [c[begin:end] for place, c in enumerate(columns) if place != clock]
        if all(np.ptp(column) == 0 for column in measured):
            continue  # a joint at rest shows no difference
        digest = hashlib.sha256()
        for column in (since, *measured):
            digest.update(np.ascontiguousarray(column + 0.0).tobytes())
        first = seen.setdefault(digest.digest(), name)
        if first != name:
            copies[name] = first
    return copies


def _by_condition(alike: Copies, ids: pd.Series, condition: pd.DataFrame) -> tuple[Copies, Copies]:
    """Divide equal groups into those of one condition and those of two."""
    if not alike:
        return {}, {}
    if condition.columns.empty:
        return alike, {}
    of_row = condition.groupby([*condition], dropna=False, observed=True).ngroup()
    kind = dict(zip(ids.astype(str), of_row, strict=True))
    copies = {copy: first for copy, first in alike.items() if kind[copy] == kind[first]}
    return copies, {copy: first for copy, first in alike.items() if copy not in copies}

"""Logs in long form: a row for each joint at each time, with a column that names the joint."""

import numpy as np

from bayesfric.arrays import Array
from bayesfric.errors import Fault, InputError
from bayesfric.logs.mapping import JOINT, Mapping, Signal, written
from bayesfric.logs.table import Cells, Log, numbers_of

MOST_JOINTS = 200
ALIKE = 0.9  # share of the times that have the same number of rows
FARTHER = 2.0  # times, from a row to the next of the same time than to that of the next time
FEWEST = 20  # least number of rows


def by_joint(log: Log, mapping: Mapping) -> Log:
    """Return a log in which each joint has columns of its own, ``position[elbow]``.

    Parameters
    ----------
    log : Log
        A log with a row for each joint at each time.
    mapping : Mapping
        Its ``joint_column`` names the joint; without it the log is returned unchanged.

    Raises
    ------
    InputError
        There is no such column, it does not name joints, or a signal has no number in a row.
    """
    if mapping.joint_column is None:
        return log
    named = log.named(mapping.joint_column)
    _check_numbers(log, mapping)
    parts = log.parted(named, MOST_JOINTS, f"the names of 1 to {MOST_JOINTS} joints")
    columns: dict[str, Cells] = {}
    units: dict[str, str] = {}
    for joint, own in parts.items():
        columns |= {_of(name, joint): cells for name, cells in own.columns.items()}
        units |= {_of(name, joint): unit for name, unit in (log.units or {}).items()}
    notes = (*log.notes, f"Rows are of the joints that {named} names: {', '.join(parts)}.")
    return Log(log.name, columns, log.first_row, notes, units or None)


def _check_numbers(log: Log, mapping: Mapping) -> None:
    """Refuse cells that are no numbers, while rows still have their numbers in the file."""
    names = [log.name_of(signal.column) for signal in mapping.signals.values()]
    faults: list[Fault] = []
    for name in dict.fromkeys(names):
        if name is not None:
            numbers_of(log, name, faults)
    if faults:
        raise InputError(faults)


def mapping_by_joint(mapping: Mapping, log: Log) -> Mapping:
    """Return the mapping for the result of :func:`by_joint`; unchanged without ``joint_column``.

    Parameters
    ----------
    mapping : Mapping
        Mapping of the log in long form.
    log : Log
        The log as read, for the names of columns that the mapping gives by number.
    """
    if mapping.joint_column is None:
        return mapping
    signals: dict[str, Signal] = {}
    for key, signal in mapping.signals.items():
        columns = {"column": signal.column, "time": mapping.clock_of(signal)}
        changed = {
            name: _of(log.named(column), JOINT)
            for name, column in columns.items()
            if column is not None
        }
        signals[key] = Signal.model_validate(written(signal) | changed)
    return mapping.model_copy(update=signals)


def _of(column: str, joint: str) -> str:
    return f"{column}[{joint}]"


def is_of_several_joints(time_s: Array, position: Array) -> bool:
    """Return whether rows at one time belong to several joints, the same number at each time.

    Parameters
    ----------
    time_s, position : ndarray, shape (N,)
        In the order of the log; NaN for a missing value.
    """
    there = np.isfinite(time_s) & np.isfinite(position)
    time_s, position = time_s[there], position[there]
    counts = np.unique(time_s, return_counts=True)[1]
    at_once = int(np.median(counts)) if counts.size else 1
    if at_once < 2 or time_s.size < FEWEST or (counts == at_once).mean() < ALIKE:
        return False
    within = np.abs(np.diff(position))[np.diff(time_s) == 0]
    later = np.abs(position[at_once:] - position[:-at_once])
    return bool(within.size and np.median(within) > FARTHER * np.median(later))

"""Signals of one joint from a log: CSV by a mapping, or a ROS 2 bag (SQLite or MCAP)."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bayesfric.arrays import Array
from bayesfric.errors import Fault, InputError
from bayesfric.logs.mapping import SECONDS, Mapping

__all__ = ["Series", "bag_signals", "csv_signals", "is_bag"]

JOINT_STATE = "sensor_msgs/msg/JointState"
NANO = 1e-9


@dataclass(frozen=True)
class Series:
    """A quantity at times, both of shape (N,), times increasing."""

    time_s: Array
    value: Array


def is_bag(path: Path) -> bool:
    """Return whether a log is a bag: a folder with its metadata, or a file of MCAP."""
    return path.suffix == ".mcap" or (path / "metadata.yaml").is_file()


def csv_signals(path: Path, mapping: Mapping, joint: str) -> dict[str, Series]:
    """Return the signals of a CSV log.

    Raises
    ------
    InputError
        A column is not there, or a cell is no number.
    """
    try:
        table = pd.read_csv(path)
    except (OSError, ValueError) as error:
        raise InputError([Fault(str(path), f"a log as CSV ({error})")]) from error
    wanted = {"position": mapping.position, "force": mapping.force}
    if mapping.measured_force is not None:
        wanted["measured_force"] = mapping.measured_force
    faults: list[Fault] = []

    def numbers(column: str) -> Array:
        if column not in table:
            known = ", ".join(map(str, table.columns[:12]))
            faults.append(Fault(path.name, f"one of {known}", column=column))
            return np.zeros(len(table))
        found = pd.to_numeric(table[column], errors="coerce")
        text = table[column].notna() & found.isna()
        if text.any():
            row = int(np.argmax(text.to_numpy()))
            value = str(table[column].iloc[row])
            faults.append(Fault(path.name, "a number", row=row + 2, column=column, value=value))
        return np.asarray(found, dtype=np.float64)

    found = {}
    for name, signal in wanted.items():
        clock = numbers(signal.time or mapping.time.column) * SECONDS[mapping.time.unit]
        value = numbers(signal.column.replace("{joint}", joint)) * mapping.scale(name, signal)
        found[name] = _in_order(clock, value)
    if faults:
        raise InputError(faults)
    return found


def bag_signals(path: Path, joint: str) -> dict[str, Series]:
    """Return position and effort of a joint from ``sensor_msgs/JointState``, by its own stamps.

    Where there is more than one such topic, the one whose name has ``command`` in it is the
    commanded effort, and the other one's is measured.

    Raises
    ------
    InputError
        The extra is not installed, or there is no such joint.
    """
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    except ImportError as error:
        expected = "an installation that reads bags: pip install 'bayesfric[logs]'"
        raise InputError([Fault(str(path), expected)]) from error
    rows: dict[str, list[tuple[float, float, float]]] = {}
    seen: set[str] = set()
    try:
        with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
            chosen = [one for one in reader.connections if one.msgtype == JOINT_STATE]
            for connection, _, raw in reader.messages(connections=chosen):
                message: Any = reader.deserialize(raw, connection.msgtype)
                names = list(message.name)
                seen.update(names)
                if joint in names:
                    rows.setdefault(connection.topic, []).append(_of_joint(message, joint, names))
    except InputError:
        raise
    except Exception as error:  # whatever a bag's reader makes of it, it is told where
        raise InputError([Fault(str(path), f"a bag that can be read ({error!r})")]) from error
    if not rows:
        known = ", ".join(sorted(seen)) or f"none: there is no {JOINT_STATE}"
        raise InputError([Fault(str(path), f"one of its joints ({known})", value=joint)])
    commanded = [topic for topic in rows if "command" in topic]
    measured = [topic for topic in rows if topic not in commanded]
    if not measured:
        expected = "a topic of measured joint states beside that of commands"
        raise InputError([Fault(str(path), expected)])
    time, position, effort = np.array(rows[measured[0]]).T
    found = {"position": _in_order(time, position)}
    if commanded:
        at, _, sent = np.array(rows[commanded[0]]).T
        found |= {"force": _in_order(at, sent), "measured_force": _in_order(time, effort)}
    else:
        found["force"] = _in_order(time, effort)
    if not found["force"].time_s.size:
        raise InputError([Fault(str(path), f"effort of the joint {joint}", value="none")])
    return found


def _of_joint(message: Any, joint: str, names: list[str]) -> tuple[float, float, float]:
    place = names.index(joint)
    stamp = message.header.stamp

    def of(values: Any) -> float:
        return float(values[place]) if len(values) > place else float("nan")

    return stamp.sec + NANO * stamp.nanosec, of(message.position), of(message.effort)


def _in_order(time: Array, value: Array) -> Series:
    """Return what is a number, by time; of equal times the first."""
    there = np.isfinite(time) & np.isfinite(value)
    at, first = np.unique(time[there], return_index=True)
    return Series(at, value[there][first])

"""Signals of one joint from a log: CSV by a mapping, or a ROS 2 bag (SQLite or MCAP)."""

from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bayesfric.arrays import Array
from bayesfric.errors import Fault, InputError
from bayesfric.logs.clock import DECIMALS, Stamps, seconds_since, stamps_of
from bayesfric.logs.mapping import Mapping, Signal
from bayesfric.logs.ordering import Ordered, Series, in_order, unwrapped

__all__ = ["Signals", "bag_signals", "csv_signals", "is_bag"]

JOINT_STATE = "sensor_msgs/msg/JointState"
NANO = 10**9


@dataclass(frozen=True)
class Signals:
    """What a log has of a joint, on one clock.

    Parameters
    ----------
    series : dict of str to Series
        ``position``, ``force`` and perhaps ``measured_force``.
    notes : tuple of str
        Sentences: what was done to clocks and rows, with counts.
    """

    series: dict[str, Series]
    notes: tuple[str, ...]


def is_bag(path: Path) -> bool:
    """Return whether a log is a bag: a folder with its metadata, or a file of MCAP."""
    return path.suffix == ".mcap" or (path / "metadata.yaml").is_file()


def csv_signals(path: Path, mapping: Mapping, joint: str) -> Signals:
    """Return the signals of a CSV log.

    Raises
    ------
    InputError
        A column is not there, a cell is no number or no time, or a clock starts anew.
    """
    wanted = {"position": mapping.position, "force": mapping.force}
    if mapping.measured_force is not None:
        wanted["measured_force"] = mapping.measured_force
    table, clocks = _read_table(path, mapping, wanted)
    faults: list[Fault] = []
    values = {
        name: _numbers(table, signal.column.replace("{joint}", joint), path.name, faults)
        * mapping.scale(name, signal)
        for name, signal in wanted.items()
    }
    stamps: dict[str, Stamps] = {}
    for column in clocks:
        if column not in table:
            faults.append(_no_column(table, column, path.name))
            continue
        cells = [None if cell is pd.NA else str(cell) for cell in table[column].tolist()]
        try:
            stamps[column] = stamps_of(cells, mapping.time.unit, path.name, column)
        except InputError as error:
            faults += error.faults
    if faults:
        raise InputError(faults)
    firsts = [found.first for found in stamps.values() if found.first is not None]
    origin = min(firsts, default=Decimal(0))
    times, notes = {}, list[str]()
    for column, found in stamps.items():
        since = seconds_since(found, origin)
        times[column], done = unwrapped(since, float(origin), found.periods_s)
        notes += [f"{column}: {note}." for note in done]
    ordered = {}
    for name, signal in wanted.items():
        column = signal.time or mapping.time.column
        ordered[name] = in_order(times[column], values[name], path.name, column)
    return _signals(ordered, notes)


def _read_table(
    path: Path, mapping: Mapping, wanted: dict[str, Signal]
) -> tuple[pd.DataFrame, list[str]]:
    """Return a log with its clocks as they are written, and the names of these columns."""
    clocks = [signal.time or mapping.time.column for signal in wanted.values()]
    try:
        table = pd.read_csv(path, dtype=dict.fromkeys(clocks, "string"), low_memory=False)
    except (OSError, ValueError) as error:
        raise InputError([Fault(str(path), f"a log as CSV ({error})")]) from error
    return table, list(dict.fromkeys(clocks))


def _numbers(table: pd.DataFrame, column: str, file: str, faults: list[Fault]) -> Array:
    """Return a column's numbers, NaN where cells are blank; what is no number goes to `faults`."""
    if column not in table:
        faults.append(_no_column(table, column, file))
        return np.zeros(len(table))
    numbers = pd.to_numeric(table[column], errors="coerce")
    text = table[column].notna() & numbers.isna()
    if text.any():
        row = int(np.argmax(text.to_numpy()))
        value = str(table[column].iloc[row])
        faults.append(Fault(file, "a number", row=row + 2, column=column, value=value))
    return np.asarray(numbers, dtype=np.float64)


def _no_column(table: pd.DataFrame, column: str, file: str) -> Fault:
    return Fault(file, f"one of {', '.join(map(str, table.columns[:12]))}", column=column)


def _signals(ordered: dict[str, Ordered], notes: list[str]) -> Signals:
    """Return the series, and each clause once, with the signals that it is of."""
    of_clause: dict[str, list[str]] = {}
    for name, signal in ordered.items():
        for clause in signal.notes:
            of_clause.setdefault(clause, []).append(name.replace("_", " "))
    notes += [f"{' and '.join(names)}: {clause}." for clause, names in of_clause.items()]
    return Signals({name: signal.series for name, signal in ordered.items()}, tuple(notes))


def bag_signals(path: Path, joint: str) -> Signals:
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
    rows: dict[str, list[tuple[int, float, float]]] = {}
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
    stamps = [row[0] for topic in (measured[0], *commanded[:1]) for row in rows[topic]]
    origin, name = min(stamps), path.name

    def of_topic(topic: str) -> tuple[Array, Array, Array]:
        since = np.array([(row[0] - origin) / NANO for row in rows[topic]]).round(DECIMALS)
        values = np.array([row[1:] for row in rows[topic]], dtype=np.float64)
        return since, values[:, 0], values[:, 1]

    time, position, effort = of_topic(measured[0])
    ordered = {"position": in_order(time, position, name, measured[0])}
    force = in_order(time, effort, name, measured[0])
    if commanded:
        at, _, sent = of_topic(commanded[0])
        ordered |= {"force": in_order(at, sent, name, commanded[0]), "measured_force": force}
    else:
        ordered["force"] = force
    if not ordered["force"].series.time_s.size:
        raise InputError([Fault(str(path), f"effort of the joint {joint}", value="none")])
    return _signals(ordered, [])


def _of_joint(message: Any, joint: str, names: list[str]) -> tuple[int, float, float]:
    place = names.index(joint)
    stamp = message.header.stamp

    def of(values: Any) -> float:
        return float(values[place]) if len(values) > place else float("nan")

    return NANO * stamp.sec + stamp.nanosec, of(message.position), of(message.effort)

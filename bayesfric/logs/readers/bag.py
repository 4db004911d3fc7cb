"""Messages of ROS 2: joint states, joint trajectories and arrays of commands, by their stamps."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from bayesfric.errors import Fault, InputError, needs_extra
from bayesfric.logs.table import LARGEST_FILE, MOST_CELLS, Cells, Log, check_cells, damaged_is_told

NANO = 10**9
FIELDS = ("position", "velocity", "effort")
Row = tuple[int, int, dict[str, float]]
"""A stamp, how long after it the numbers hold [ns], and the numbers."""


def read_bag(path: Path) -> Log:
    """Return the columns of a bag that rosbags reads: a folder, or a file of MCAP.

    Reception stands for stamps where all of a topic are 0: one of 0 alone is when a simulation
    begins. Of a trajectory a stamp of 0 says that it begins as it is received.

    A topic ``/joint_states`` has ``/joint_states.stamp`` (ns) and, of each joint,
    ``/joint_states.position[elbow]``, ``.velocity[…]`` and ``.effort[…]``.

    Raises
    ------
    InputError
        rosbags is not installed; the bag is damaged or has none of these messages.
    """
    with needs_extra("logs", "an installation that reads bags", str(path)):
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    tables: dict[str, list[Row]] = {}
    receptions: dict[str, list[int]] = {}
    rows = 0
    with damaged_is_told(path, "a bag"):
        store = get_typestore(Stores.ROS2_HUMBLE)
        with AnyReader([path], default_typestore=store) as reader:
            chosen = [link for link in reader.connections if link.msgtype in MESSAGES]
            types = sorted({link.msgtype for link in reader.connections})
            for link, received, raw in reader.messages(connections=chosen):
                if len(raw) > LARGEST_FILE:
                    raise InputError([Fault(path.name, "messages of a few kilobytes")])
                message = reader.deserialize(raw, link.msgtype)
                for row in MESSAGES[link.msgtype](message):
                    tables.setdefault(link.topic, []).append(row)
                    receptions.setdefault(link.topic, []).append(received)
                    rows += len(row[-1]) + 1
                    if rows > MOST_CELLS // 8:
                        check_cells(path.name, MOST_CELLS + 1)
    if not tables:
        kinds = ", ".join(sorted(MESSAGES))
        raise InputError(
            [Fault(path.name, f"messages of {kinds} (it has: {', '.join(types) or 'none'})")]
        )
    begin_now = {link.topic for link in chosen if link.msgtype == TRAJECTORY}
    unstamped = {
        topic
        for topic, table in tables.items()
        if (any if topic in begin_now else all)(stamp <= 0 for stamp, _, _ in table)
    }
    notes = tuple(
        f"{topic}: its messages have no stamps; the times of reception are taken."
        for topic in sorted(unstamped)
    )
    columns: dict[str, Cells] = {}
    for topic, table in tables.items():
        received_ns = receptions[topic] if topic in unstamped else None
        columns |= _columns(topic, table, received_ns)
    return Log(path.name, columns, 1, notes)


def _columns(topic: str, table: list[Row], received_ns: list[int] | None) -> dict[str, Cells]:
    names = list(dict.fromkeys(name for _, _, values in table for name in values))
    stamps = [stamp for stamp, _, _ in table]
    if received_ns is not None:
        both = zip(stamps, received_ns, strict=True)
        stamps = [stamp if stamp > 0 else received for stamp, received in both]
    times = [stamp + row[1] for stamp, row in zip(stamps, table, strict=True)]
    columns: dict[str, Cells] = {f"{topic}.stamp": np.array(times, dtype=np.int64)}
    nothing = float("nan")
    for name in names:
        cells = np.array([values.get(name, nothing) for _, _, values in table], dtype=np.float64)
        columns[f"{topic}.{name}"] = cells
    return columns


def _stamp(message: Any) -> int:
    return int(NANO * message.header.stamp.sec + message.header.stamp.nanosec)


def _joint_state(message: Any) -> Iterator[Row]:
    yield (
        _stamp(message),
        0,
        {
            f"{field}[{joint}]": float(value)
            for field in FIELDS
            for joint, value in zip(message.name, getattr(message, field), strict=False)
        },
    )


def _trajectory(message: Any) -> Iterator[Row]:
    """Yield the points of a trajectory, at the times at which they are to be reached."""
    began = _stamp(message)
    for point in message.points:
        after = int(NANO * point.time_from_start.sec + point.time_from_start.nanosec)
        values = {
            f"{field}[{joint}]": float(value)
            for field, numbers in (
                ("position", point.positions),
                ("velocity", point.velocities),
                ("effort", point.effort),
            )
            for joint, value in zip(message.joint_names, numbers, strict=False)
        }
        yield began, after, values


def _array(message: Any) -> Iterator[Row]:
    yield 0, 0, {f"data[{place}]": float(value) for place, value in enumerate(message.data)}


TRAJECTORY = "trajectory_msgs/msg/JointTrajectory"
MESSAGES: dict[str, Callable[[Any], Iterator[Row]]] = {
    "sensor_msgs/msg/JointState": _joint_state,
    TRAJECTORY: _trajectory,
    "std_msgs/msg/Float64MultiArray": _array,
}
"""Messages that are read, and how."""

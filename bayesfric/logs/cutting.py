"""Cuts signals of joints to the runs of a recording, at the times of the positions."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from bayesfric.arrays import Array, Flags
from bayesfric.errors import Fault, InputError
from bayesfric.logs.clock import DECIMALS
from bayesfric.logs.mapping import Run
from bayesfric.logs.ordering import GAP, Series, counted, gaps_of

COLUMNS = {"force": "force_n", "known_force": "known_force_n", "temperature": "temperature_c"}
"""Signals that are interpolated linearly at the times of the positions, and their columns."""
LEADS = ("force", "command")
NOT_BRIDGED = ("force", "known_force")
"""Signals that are not interpolated across gaps; a command holds until the next one."""
NEEDED = (*LEADS, "known_force")
"""Signals, besides positions, without which a sample is left out instead of filled in."""


@dataclass(frozen=True)
class Window:
    """The time window of a run in a log.

    Parameters
    ----------
    run : Run
        Its name, role and covariates.
    begin_s, end_s : float
        Begin and end since the origin of the times.
    """

    run: Run
    begin_s: float
    end_s: float


def span_of(name: str, signals: dict[str, Series]) -> tuple[float, float]:
    """Return the interval in which all the signals are logged [s].

    Raises
    ------
    InputError
        There is no such interval.
    """
    needed = [signals["position"], *(signals[key] for key in NEEDED if key in signals)]
    begin = max(series.time_s[:1].max(initial=-np.inf) for series in needed)
    end = min(series.time_s[-1:].min(initial=np.inf) for series in needed)
    if not all(series.time_s.size for series in needed) or not begin < end:
        others = " and ".join(key.replace("_", " ") for key in NEEDED if key in signals)
        raise InputError([Fault(name, f"position and {others} that are logged at the same time")])
    return begin, end


def cut(
    name: str, signals: dict[str, Series], windows: Sequence[Window], origin_s: float
) -> tuple[list[pd.DataFrame], list[str]]:
    """Return the samples of each run, and notes on what was done.

    Parameters
    ----------
    name : str
        Name of the log, for errors.
    signals : dict of str to Series
        Signals of one joint.
    windows : sequence of Window
        The runs.
    origin_s : float
        Origin of the times of the recording.

    Raises
    ------
    InputError
        A run has no samples.
    """
    position = signals["position"]
    begin, end = span_of(name, signals)
    unlogged = {
        key: _unlogged(position.time_s, signals[key]) for key in NOT_BRIDGED if key in signals
    }
    frames, faults = [], []
    for window in windows:
        low, high = max(window.begin_s, begin), min(window.end_s, end)
        inside = (position.time_s >= low) & (position.time_s <= high)
        for without in unlogged.values():
            inside &= ~without
        if inside.sum() < 2:
            faults.append(Fault(name, "samples in the run", column=f"runs.{window.run.name}"))
            continue
        time = position.time_s[inside]
        columns: dict[str, Any] = {
            "run": window.run.name,
            "time_s": (time - origin_s).round(DECIMALS),
            "position_m": position.value[inside].round(DECIMALS),
        }
        for key, column in COLUMNS.items():
            if key in signals:
                series = signals[key]
                columns[column] = np.interp(time, series.time_s, series.value).round(DECIMALS)
        if "command" in signals:
            columns |= _held(time, signals["command"], origin_s)
        frames.append(pd.DataFrame(columns))
    if faults:
        raise InputError(faults)
    return frames, _notes(signals, unlogged)


def _held(time: Array, command: Series, origin_s: float) -> dict[str, Array]:
    """Return the command that is held at each time, and its start."""
    last = np.searchsorted(command.time_s, time, side="right") - 1
    since = command.time_s[last]
    columns = {"command_m": command.value[last].round(DECIMALS)}
    if not np.array_equal(since, time):
        columns["command_time_s"] = (since - origin_s).round(DECIMALS)
    return columns


def _notes(signals: dict[str, Series], unlogged: dict[str, Flags]) -> list[str]:
    notes, position = [], signals["position"]
    for key, without in unlogged.items():
        if without.any():
            called = key.replace("_", " ")
            samples = counted(int(without.sum()), "sample")
            notes.append(f"{samples} in which no {called} was logged left out.")
    for key in COLUMNS:
        if key in signals and not np.array_equal(position.time_s, signals[key].time_s):
            called = key.replace("_", " ").capitalize()
            notes.append(
                f"{called} is a straight line between its samples, at the times of the positions."
            )
    if "temperature" in signals:
        notes += _held_ends(position, signals["temperature"])
    command = signals.get("command")
    if command is not None and not np.array_equal(position.time_s, command.time_s):
        notes.append("A command holds until the next one.")
    return notes


def _held_ends(position: Series, temperature: Series) -> list[str]:
    """Return a note that the first or last temperature is used where none was logged."""
    first, last = temperature.time_s[[0, -1]]
    before_s, after_s = first - position.time_s[0], position.time_s[-1] - last
    longest = max(before_s, after_s)
    steps = np.diff(temperature.time_s)
    if longest <= GAP * (float(np.median(steps)) if steps.size else 0.0):
        return []
    return [
        "Temperature is that of its nearest sample before its first and after its last, for up to "
        f"{longest:.4g} s."
    ]


def _unlogged(time_s: Array, force: Series) -> Flags:
    """Return where a force was not logged for several intervals, (N,): no interpolation there."""
    begin, end = gaps_of(force)
    if not begin.size:
        return np.zeros(time_s.size, dtype=np.bool_)
    gap = np.searchsorted(begin, time_s, side="left") - 1
    inside: Flags = (gap >= 0) & (time_s < end[gap])
    return inside

"""The signals of a log's joints by a mapping, on one clock, in the units of a recording."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from bayesfric.arrays import Array
from bayesfric.errors import Fault, InputError, first_of, near
from bayesfric.logs.clock import DECIMALS, Stamps, seconds_since, stamps_of
from bayesfric.logs.long_form import is_of_several_joints
from bayesfric.logs.mapping import JOINT, Mapping, scale_of
from bayesfric.logs.ordering import Series, in_order, unwrapped
from bayesfric.logs.table import LISTED, Log, numbers_of, texts_of

ALL = "all"
OPTIONAL = ("measured_force", "velocity", "known_force", "temperature")
"""Signals that a mapping may leave out; a blank column counts as absent."""
RATE = "time.rate_hz"
OR_LEAVE_OUT = "leave it out where it is blank"
ONE_JOINT = (
    "rows of one joint, and each time has rows of several: say which column names the joint, "
    'joint_column = "…", at the top of the mapping'
)


@dataclass(frozen=True)
class Signals:
    """The signals of a joint, on one clock.

    Parameters
    ----------
    series : dict of str to Series
        ``position``, ``force`` or ``command``, and further signals of the mapping.
    notes : tuple of str
        Corrections of clocks and rows, with counts, a sentence each.
    """

    series: dict[str, Series]
    notes: tuple[str, ...]


def joints_of(log: Log, mapping: Mapping, joint: str | None) -> tuple[str | None, ...]:
    """Return the joints that are requested.

    Parameters
    ----------
    log : Log
        The log, which has the names.
    mapping : Mapping
        The mapping, with or without a placeholder for the name.
    joint : str or None
        A name, or ``all``.

    Raises
    ------
    InputError
        There is no such joint, or none is named although there are several.
    """
    if not mapping.is_of_any_joint:
        if joint == ALL:
            return _joints_with_columns(mapping)
        if joint is not None and mapping.joints and joint not in mapping.joints:
            raise InputError([_no_joint("the mapping", joint, list(mapping.joints))])
        if (
            joint is None
            and mapping.joints
            and len(_with_own_position(mapping)) == len(mapping.joints)
        ):
            raise InputError([_which(list(mapping.joints))])
        return (joint,)
    names = _joints(log, mapping)
    if joint == ALL:
        if not names:
            column = str(mapping.position.column)
            raise InputError([Fault(log.name, f"columns like {column}", column="position.column")])
        return tuple(names)
    if joint is None:
        raise InputError([_which(names)])
    if joint not in names and _patterns(mapping):
        raise InputError([_no_joint(log.name, joint, names)])
    return (joint,)


def _which(names: list[str]) -> Fault:
    joints = first_of(names, LISTED) or "(there is none)"
    return Fault("--joint", f"all, or one of the joints {joints}")


def _no_joint(where: str, joint: str, names: list[str]) -> Fault:
    listed = first_of(names, LISTED) or "there is none"
    expected = f"all, or one of its joints ({listed}){near(joint, names)}"
    return Fault(where, expected, column="--joint", value=joint)


def _joints_with_columns(mapping: Mapping) -> tuple[str, ...]:
    """Return the joints that the mapping names, each with a position column of its own."""
    names = _with_own_position(mapping)
    columns = {mapping.of_joint(joint)["position"].column for joint in names}
    if not names or len(columns) < len(mapping.joints):
        expected = (
            f"columns with {JOINT} in their names, or [joints.NAME.position] with a column for "
            "each joint, where --joint is all"
        )
        raise InputError([Fault("the mapping", expected, column="position.column")])
    return tuple(names)


def _with_own_position(mapping: Mapping) -> list[str]:
    return [joint for joint, own in mapping.joints.items() if "column" in own.get("position", {})]


def _joints(log: Log, mapping: Mapping) -> list[str]:
    """Return the names for which columns of position and force exist."""
    names: list[str] | None = None
    for pattern in _patterns(mapping):
        before, after = (re.escape(part) for part in pattern.split(JOINT, 1))
        form = re.compile(f"{before}(.+){after.replace(re.escape(JOINT), '.+')}")
        matches = [match.group(1) for column in log.columns if (match := form.fullmatch(column))]
        names = [name for name in names if name in matches] if names is not None else matches
    return names or []


def _patterns(mapping: Mapping) -> list[str]:
    """Return the columns of position and force with a placeholder for the name of a joint."""
    return [
        str(signal.column)
        for key in ("position", "force", "command")
        if (signal := mapping.signals.get(key)) and JOINT in str(signal.column)
    ]


def wanted_columns(mapping: Mapping) -> set[str | int] | None:
    """Return the columns that a mapping names; None if it has a placeholder for joints."""
    if mapping.is_of_any_joint or mapping.joints:
        return None
    signals = mapping.signals.values()
    columns = {signal.column for signal in signals}
    clocks = {mapping.clock_of(signal) for signal in signals}
    keys = {mapping.run, mapping.joint_column}
    return {column for column in columns | clocks | keys if column is not None}


def signals_of(
    log: Log, mapping: Mapping, joints: tuple[str | None, ...]
) -> dict[str | None, Signals]:
    """Return the signals of each joint; time counts from the first of all stamps.

    Raises
    ------
    InputError
        A column is missing, a cell is no number or no time, or a clock restarts.
    """
    faults: list[Fault] = []
    wanted = {joint: _columns(log, mapping, joint, faults) for joint in joints}
    every = [column for columns in wanted.values() for column in columns.values()]
    stamps = _stamps(log, mapping, every, faults)
    numbers = {column: numbers_of(log, column.name, faults) * column.scale for column in every}
    faults += _of_other_lengths(log, every)
    if faults:
        raise InputError(list(dict.fromkeys(faults)))
    times, notes = _times(log, mapping, stamps)
    of_joints = {}
    for joint, columns in wanted.items():
        series: dict[str, Series] = {}
        clauses: dict[str, list[str]] = {}
        for key, column in columns.items():
            value, clock = numbers[column], column.clock or RATE
            time = times[clock] if column.clock else _of_rate(mapping, value.size)
            series[key], done = in_order(time, value, log.name, clock, log.first_row)
            for clause in done:
                clauses.setdefault(clause, []).append(key.replace("_", " "))
            if key == "position" and is_of_several_joints(time, value):
                faults.append(Fault(log.name, ONE_JOINT, column=column.name))
            if key in OPTIONAL and not series[key].time_s.size:
                expected = f"some number, where the mapping has [{key}]: {OR_LEAVE_OUT}"
                faults.append(Fault(log.name, expected, column=column.name, value="no number"))
        said = [f"{' and '.join(keys)}: {clause}." for clause, keys in clauses.items()]
        of_joints[joint] = Signals(series, (*notes, *said))
    if faults:
        raise InputError(faults)
    return of_joints


class _Column(NamedTuple):
    """A signal's column and clock by their names in the log; without a clock at a rate."""

    name: str
    clock: str | None
    scale: float


def _columns(
    log: Log, mapping: Mapping, joint: str | None, faults: list[Fault]
) -> dict[str, _Column]:
    """Return the columns of a joint's signals; `faults` receives those that the log lacks."""
    columns = {}
    for key, signal in mapping.of_joint(joint).items():
        clock = mapping.clock_of(signal)
        places = [signal.column] if clock is None else [signal.column, clock]
        names = [name for place in places if (name := log.name_of(place)) is not None]
        faults += [log.no_column(place) for place in places if log.name_of(place) is None]
        if len(names) == len(places):
            columns[key] = _Column(
                names[0], None if clock is None else names[1], scale_of(key, signal)
            )
    return columns


def _stamps(
    log: Log, mapping: Mapping, columns: list[_Column], faults: list[Fault]
) -> dict[str, Stamps]:
    """Return the stamps of every clock of a signal, by column."""
    stamps: dict[str, Stamps] = {}
    for clock in dict.fromkeys(column.clock for column in columns if column.clock is not None):
        cells = texts_of(log.columns[clock])
        try:
            stamps[clock] = stamps_of(cells, mapping.time.unit, log.name, clock, log.first_row)
        except InputError as error:
            faults += error.faults
    return stamps


def _of_other_lengths(log: Log, columns: list[_Column]) -> Iterator[Fault]:
    """Yield the columns that are not as long as their clock, or as the first one at the rate."""
    of_rate = [column.name for column in columns if column.clock is None]
    for column in columns:
        other = column.clock or of_rate[0]
        rows, expected = (len(log.columns[name]) for name in (column.name, other))
        why = f"as its clock {other} has"
        if column.clock is None:
            why = (
                f"as {other} has, where {RATE} stands for their clock: which rows belong together "
                "is not known; take columns of a clock"
            )
        if rows != expected:
            value = f"{rows:,} rows"
            yield Fault(log.name, f"{expected:,} rows, {why}", column=column.name, value=value)


def _of_rate(mapping: Mapping, rows: int) -> Array:
    """Return the times of rows at a constant rate, (N,), rounded as stamps are."""
    step = 1 / Fraction(repr(mapping.time.rate_hz))
    since = np.array([float(row * step) for row in range(rows)], dtype=np.float64)
    return np.asarray(since.round(DECIMALS))


def _times(
    log: Log, mapping: Mapping, stamps: dict[str, Stamps]
) -> tuple[dict[str, Array], list[str]]:
    firsts = [of_clock.first for of_clock in stamps.values() if of_clock.first is not None]
    origin = min(firsts, default=Decimal(0))
    times, notes = {}, list(log.notes)
    if mapping.time.column is None and mapping.time.rate_hz is not None:
        notes.append(f"The log has no clock: {mapping.time.rate_hz:g} samples a second are taken.")
    for column, of_column in stamps.items():
        since = seconds_since(of_column, origin)
        times[column], done = unwrapped(since, float(origin), of_column.periods_s, log.first_row)
        notes += [f"{column}: {note}." for note in done]
    return times, notes

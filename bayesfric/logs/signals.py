"""The signals of a log's joints by a mapping, on one clock, in the units of a recording."""

import re
from collections.abc import Mapping as Of
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction

import numpy as np

from bayesfric.arrays import Array
from bayesfric.errors import Fault, InputError, near
from bayesfric.logs.clock import DECIMALS, Stamps, seconds_since, stamps_of
from bayesfric.logs.long_form import is_of_several_joints
from bayesfric.logs.mapping import JOINT, Mapping, Signal, scale_of
from bayesfric.logs.ordering import Ordered, Series, in_order, unwrapped
from bayesfric.logs.table import Log, numbers_of, texts_of

ALL = "all"
LISTED = 12
OPTIONAL = ("measured_force", "velocity", "known_force", "temperature")
"""Signals that a mapping may leave out; a blank column counts as absent."""


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


def _listed(names: list[str]) -> str:
    return ", ".join(names[:LISTED]) + (", …" if len(names) > LISTED else "")


def _which(names: list[str]) -> Fault:
    return Fault("--joint", f"all, or one of the joints {_listed(names) or '(there is none)'}")


def _no_joint(where: str, joint: str, names: list[str]) -> Fault:
    listed = _listed(names) or "there is none"
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
    wanted = {joint: mapping.of_joint(joint) for joint in joints}
    faults: list[Fault] = []
    stamps = _stamps(log, mapping, wanted, faults)
    values = {
        (joint, name): _values(log, mapping, name, signal, faults)
        for joint, signals in wanted.items()
        for name, signal in signals.items()
    }
    faults = faults or _of_one_rate(log, mapping, wanted)
    if faults:
        raise InputError(list(dict.fromkeys(faults)))
    times, said = _times(log, mapping, stamps)
    of_joints = {}
    for joint, signals in wanted.items():
        ordered = {}
        for name, signal in signals.items():
            value = values[joint, name]
            clock = mapping.clock_of(signal)
            time = _of_rate(mapping, value.size) if clock is None else times[_name(log, clock)]
            ordered[name] = in_order(time, value, log.name, _called(log, clock), log.first_row)
            if name == "position" and is_of_several_joints(time, value):
                faults.append(_several_joints(log, signal))
            if name in OPTIONAL and not ordered[name].series.time_s.size:
                faults.append(_blank(log, name, signal))
        of_joints[joint] = _signals(ordered, said)
    if faults:
        raise InputError(faults)
    return of_joints


def _several_joints(log: Log, signal: Signal) -> Fault:
    expected = (
        "rows of one joint, and each time has rows of several: say which column names the joint, "
        'joint_column = "…", at the top of the mapping'
    )
    return Fault(log.name, expected, column=_name(log, signal.column))


def _blank(log: Log, name: str, signal: Signal) -> Fault:
    expected = f"some number, where the mapping has [{name}]: leave it out where it is blank"
    return Fault(log.name, expected, column=_name(log, signal.column), value="no number")


def _name(log: Log, column: str | int) -> str:
    name = log.name_of(column)
    if name is None:
        raise InputError([log.no_column(column)])
    return name


def _called(log: Log, clock: str | int | None) -> str:
    return "time.rate_hz" if clock is None else _name(log, clock)


def _stamps(
    log: Log,
    mapping: Mapping,
    wanted: Of[str | None, Of[str, Signal]],
    faults: list[Fault],
) -> dict[str, Stamps]:
    """Return the stamps of every clock of a signal, by column."""
    clocks = [
        mapping.clock_of(signal) for signals in wanted.values() for signal in signals.values()
    ]
    stamps: dict[str, Stamps] = {}
    for clock in dict.fromkeys(clocks):
        if clock is None:
            continue
        column = log.name_of(clock)
        if column is None:
            faults.append(log.no_column(clock))
            continue
        cells = texts_of(log.columns[column])
        try:
            stamps[column] = stamps_of(cells, mapping.time.unit, log.name, column, log.first_row)
        except InputError as error:
            faults += error.faults
    return stamps


def _values(log: Log, mapping: Mapping, name: str, signal: Signal, faults: list[Fault]) -> Array:
    column = log.name_of(signal.column)
    if column is None:
        faults.append(log.no_column(signal.column))
        return np.zeros(0)
    clock = mapping.clock_of(signal)
    of_clock = None if clock is None else log.name_of(clock)
    if of_clock is not None and len(log.columns[of_clock]) != len(log.columns[column]):
        expected = f"{len(log.columns[of_clock]):,} rows, as its clock {of_clock} has"
        rows = f"{len(log.columns[column]):,} rows"
        faults.append(Fault(log.name, expected, column=column, value=rows))
    return numbers_of(log, column, faults) * scale_of(name, signal)


def _of_one_rate(
    log: Log, mapping: Mapping, wanted: Of[str | None, Of[str, Signal]]
) -> list[Fault]:
    """Return a fault if columns with one rate belong to tables of different lengths."""
    rows = {
        _name(log, signal.column): len(log.columns[_name(log, signal.column)])
        for signals in wanted.values()
        for signal in signals.values()
        if mapping.clock_of(signal) is None
    }
    if not rows:
        return []
    first, *others = rows
    expected = (
        f"{rows[first]:,} rows, as {first} has, where time.rate_hz stands for their clock: "
        "which rows belong together is not known; take columns of a clock"
    )
    return [
        Fault(log.name, expected, column=column, value=f"{rows[column]:,} rows")
        for column in others
        if rows[column] != rows[first]
    ]


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


def _signals(ordered: dict[str, Ordered], before: list[str]) -> Signals:
    """Return the series, and each note once, with its signals."""
    of_clause: dict[str, list[str]] = {}
    for name, signal in ordered.items():
        for clause in signal.notes:
            of_clause.setdefault(clause, []).append(name.replace("_", " "))
    notes = [*before]
    notes += [f"{' and '.join(names)}: {clause}." for clause, names in of_clause.items()]
    return Signals({name: signal.series for name, signal in ordered.items()}, tuple(notes))

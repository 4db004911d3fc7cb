"""Reads and checks the file of a mapping; every fault has its key."""

import math
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, TypeAlias

from pydantic import ValidationError

from bayesfric.errors import Fault, InputError, one_of
from bayesfric.files import key_faults, read_toml
from bayesfric.logs.mapping import FORCE_IS, JOINT, SAY, SIGNALS, Mapping, Signal, written
from bayesfric.logs.readers.csv import SEPARATORS
from bayesfric.logs.units import ELECTRIC, FORCES, LENGTHS, ROTARY, STRAIGHT, TORQUES

PAGE = "docs/howto/log.md"
FORMULA = ("=", "+", "-", "@", "\t", "\r")  # first characters of a formula in a cell

Broken: TypeAlias = tuple[str, str, str | None]
"""A rule that a mapping breaks: the key, what is expected there, and the value, if there is one."""


def read_mapping(path: Path) -> Mapping:
    """Return the mapping of a file.

    Raises
    ------
    InputError
        With every fault of the file.
    """
    return checked_mapping(read_toml(path), path.name)


def checked_mapping(keys: dict[str, Any], name: str) -> Mapping:
    """Return a mapping from its keys; `name` is the name of the file in errors."""
    keys = _with_columns(keys)
    placeholders = [*_placeholders(keys)]
    try:
        mapping = Mapping.model_validate(keys)
    except ValidationError as error:
        faults = key_faults(name, error, PAGE, Mapping)
        wrong = {fault.column for fault in faults}
        placeholders = [rule for rule in placeholders if rule[0] not in wrong]
        raise InputError([*faults, *_faults(name, placeholders)]) from error
    if faults := _faults(name, placeholders or _broken_rules(mapping)):
        raise InputError(faults)
    return mapping


def _faults(name: str, broken: Iterable[Broken]) -> list[Fault]:
    return [
        Fault(name, expected, column=key, value=value)
        for key, expected, value in dict.fromkeys(broken)
    ]


def _with_columns(keys: dict[str, Any]) -> dict[str, Any]:
    """Return keys in which a signal has a column, that of the first joint, if only joints give one.

    No joint uses it, since each has a column of its own.
    """
    joints = keys.get("joints")
    of_joints = list(joints.values()) if isinstance(joints, dict) else []
    said = dict(keys)
    for key in SIGNALS:
        own = [of_joint.get(key) for of_joint in of_joints if isinstance(of_joint, dict)]
        columns = [
            signal["column"] for signal in own if isinstance(signal, dict) and "column" in signal
        ]
        signal = keys.get(key)
        if isinstance(signal, dict) and columns and len(columns) == len(of_joints):
            said[key] = {"column": columns[0], **signal}
    return said


def _placeholders(keys: dict[str, Any], before: str = "") -> Iterator[Broken]:
    """Yield each placeholder of a proposal that was not edited."""
    for key, value in keys.items():
        if isinstance(value, dict):
            yield from _placeholders(value, f"{before}{key}.")
        elif value == SAY:
            yield f"{before}{key}", "the right value, which the log does not state", SAY


def _broken_rules(mapping: Mapping) -> Iterator[Broken]:
    """Yield the rules that a mapping breaks; those of signals only if all others are obeyed."""
    others = [*_of_csv(mapping), *_of_time(mapping), *_of_joint_column(mapping)]
    others += _of_joints(mapping)
    yield from others
    if not others:
        for joint in (None, *mapping.joints):
            place = "" if joint is None else f"joints.{joint}."
            for key, signal in mapping.of_joint(joint).items():
                yield from _of_signal(mapping, place + key, key, signal)
    yield from _of_runs(mapping)


def _of_csv(mapping: Mapping) -> Iterator[Broken]:
    form = mapping.csv
    if form is None:
        return
    key, separator = "csv.separator", form.separator
    if separator not in SEPARATORS and (len(separator) != 1 or separator in '"\r\n0123456789.'):
        yield key, 'one character, "tab", or "space" for any blanks', separator
    elif form.decimal == "," and separator in (",", "comma"):
        yield key, "a separator other than a comma, since the decimal mark is one", separator


def _of_time(mapping: Mapping) -> Iterator[Broken]:
    time, force = mapping.time, mapping.force
    if time.column is not None and time.rate_hz is not None:
        yield "time.rate_hz", "a column or a rate, not both", None
    if time.column is None and time.rate_hz is None:
        yield "time.column", "the column of the clock, or rate_hz where the log has none", None
    if force is None and mapping.command is None:
        expected = "the column of a force, or [command] where only positions were commanded"
        yield "force", expected, None
    if force is not None and force.force_is is None:
        expected = (
            f"one of {', '.join(FORCE_IS)}: what the force is decides what it can tell "
            "(motor: from its current; link: behind the gear)"
        )
        yield "force.force_is", expected, None
    if mapping.measured_force is not None and force is None:
        expected = "[force], where [measured_force] stands: the command beside what was measured"
        yield "force", expected, None


def _of_joints(mapping: Mapping) -> Iterator[Broken]:
    for joint, own in mapping.joints.items():
        for key, changes in own.items():
            place = f"joints.{joint}.{key}"
            if key not in mapping.signals:
                yield place, one_of(tuple(mapping.signals), key), None
                continue
            try:
                Signal.model_validate({**written(mapping.signals[key]), **changes})
            except ValidationError as error:
                for fault in key_faults(place, error, PAGE, Signal):
                    yield f"{place}.{fault.column}", fault.expected, fault.value


def _of_joint_column(mapping: Mapping) -> Iterator[Broken]:
    """Yield the columns of single joints, if a column names the joint of each row."""
    if mapping.joint_column is None:
        return
    expected = "a column that all joints share, where joint_column stands"
    for joint, signals in mapping.joints.items():
        for key, changes in signals.items():
            if "column" in changes:
                yield f"joints.{joint}.{key}.column", expected, None
    for key, signal in mapping.signals.items():
        if JOINT in str(signal.column):
            yield f"{key}.column", expected, None


def _of_signal(mapping: Mapping, place: str, key: str, signal: Signal) -> Iterator[Broken]:
    units, unit, factor = SIGNALS[key], signal.unit, signal.factor
    if unit not in units:
        yield f"{place}.unit", one_of(tuple(units), unit), unit
        return
    if unit in ELECTRIC and units is FORCES and factor is None:
        what = "N·m" if mapping.rotary else "N"
        of_all = {"share": "all of the PWM", "%": "all of the PWM", "raw": "1"}
        of = of_all.get(unit, f"1 {unit.removeprefix('m')}")
        expected = f"{what} for {of}: the torque constant; a gear is gear_ratio"
        yield f"{place}.factor", expected, None
    if unit == "tick" and factor is None and signal.counts_per_turn is None:
        expected = "counts of the encoder a turn, where unit is tick"
        yield f"{place}.counts_per_turn", expected, None
    if unit == "tick" and factor is not None and signal.counts_per_turn is not None:
        expected = "counts_per_turn or a factor, not both: each says what a tick is"
        yield f"{place}.factor", expected, f"{factor:g}"
    if signal.counts_per_turn is not None and unit != "tick":
        yield f"{place}.unit", 'unit = "tick", where counts_per_turn stands', unit
    of_position = mapping.position.unit
    is_of_force = units is FORCES and of_position in LENGTHS
    wrong = (STRAIGHT if mapping.rotary else TORQUES) if is_of_force else {}
    if unit in wrong and factor is None:
        expected = (
            f"a torque, since position is in {of_position}, or the lever in m as factor"
            if mapping.rotary
            else f"a force, since position is in {of_position}, or 1/m as factor"
        )
        yield f"{place}.unit", expected, unit
    if key == "position" and (unit in ROTARY) != mapping.rotary:
        expected = (
            f"a unit as that of the other joints, {of_position}: joints that turn and "
            "joints that slide are recordings of their own"
        )
        yield f"{place}.unit", expected, unit
    if key == "command" and (unit in ROTARY) != mapping.rotary:
        yield f"{place}.unit", f"a unit as that of the position, {of_position}", unit


def _of_runs(mapping: Mapping) -> Iterator[Broken]:
    names = [run.name for run in mapping.runs]
    for run in mapping.runs:
        place, further = f"runs.{run.name}", run.model_extra or {}
        if run.to_s is not None and run.to_s <= (run.from_s or 0.0):
            yield place, "to_s above from_s", f"{run.to_s:g}"
        for text in (run.name, *further):
            if text.startswith(FORMULA):
                yield "runs", "a name that no spreadsheet takes for a formula", text
        for key, value in further.items():
            is_finite = isinstance(value, float) and math.isfinite(value)
            if not isinstance(value, str | int) and not is_finite:
                yield f"{place}.{key}", "a number or a text", str(value)
        if names.count(run.name) > 1:
            yield place, "a different name for each run", None

"""Reads and checks the file of a mapping; every fault has its key."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from bayesfric.errors import Fault, InputError, one_of
from bayesfric.files import key_faults, read_toml
from bayesfric.logs.mapping import FORCE_IS, JOINT, SAY, SIGNALS, Mapping, Signal, written
from bayesfric.logs.units import FORCES, LENGTHS, ROTARY, STRAIGHT, TORQUES, needs_factor

PAGE = "docs/howto/log.md"
FORMULA = ("=", "+", "-", "@", "\t", "\r")  # first characters of a formula in a cell


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
    try:
        mapping = Mapping.model_validate(keys)
    except ValidationError as error:
        faults = key_faults(name, error, PAGE, Mapping)
        wrong = {fault.column for fault in faults}
        unsaid = [fault for fault in _unsaid(keys, name) if fault.column not in wrong]
        raise InputError([*faults, *unsaid]) from error
    if unsaid := list(_unsaid(keys, name)):
        raise InputError(unsaid)
    faults = _of_csv(mapping, name) + _of_time(mapping, name) + _of_joints(mapping, name)
    if not faults:
        for joint in (None, *mapping.joints):
            place = "" if joint is None else f"joints.{joint}."
            for key, signal in mapping.of_joint(joint).items():
                faults += _of_signal(mapping, name, place + key, key, signal)
    faults += _of_runs(mapping, name)
    if faults:
        raise InputError(list(dict.fromkeys(faults)))
    return mapping


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


def _unsaid(keys: dict[str, Any], name: str, before: str = "") -> Iterator[Fault]:
    """Yield a fault for each placeholder of a proposal that was not edited."""
    for key, value in keys.items():
        if isinstance(value, dict):
            yield from _unsaid(value, name, f"{before}{key}.")
        elif value == SAY:
            expected = "the right value, which the log does not state"
            yield Fault(name, expected, column=f"{before}{key}", value=SAY)


def _of_csv(mapping: Mapping, name: str) -> list[Fault]:
    form = mapping.csv
    if form is None:
        return []
    named = form.separator in ("tab", "comma", "semicolon", "space")
    if not named and (len(form.separator) != 1 or form.separator in '"\r\n0123456789.'):
        expected = 'one character, "tab", or "space" for any blanks'
        return [Fault(name, expected, column="csv.separator", value=form.separator)]
    if form.decimal == "," and form.separator in (",", "comma"):
        expected = "a separator other than a comma, since the decimal mark is one"
        return [Fault(name, expected, column="csv.separator", value=form.separator)]
    return []


def _of_time(mapping: Mapping, name: str) -> list[Fault]:
    time = mapping.time
    faults = []
    if time.column is not None and time.rate_hz is not None:
        faults.append(Fault(name, "a column or a rate, not both", column="time.rate_hz"))
    if time.column is None and time.rate_hz is None:
        expected = "the column of the clock, or rate_hz where the log has none"
        faults.append(Fault(name, expected, column="time.column"))
    if mapping.force is None and mapping.command is None:
        expected = "the column of a force, or [command] where only positions were commanded"
        faults.append(Fault(name, expected, column="force"))
    if mapping.force is not None and mapping.force.force_is is None:
        expected = (
            f"one of {', '.join(FORCE_IS)}: what the force is decides what it can tell "
            "(motor: from its current; link: behind the gear)"
        )
        faults.append(Fault(name, expected, column="force.force_is"))
    if mapping.measured_force is not None and mapping.force is None:
        expected = "[force], where [measured_force] stands: the command beside what was measured"
        faults.append(Fault(name, expected, column="force"))
    return faults


def _of_joints(mapping: Mapping, name: str) -> list[Fault]:
    faults = _of_joint_column(mapping, name)
    for joint, own in mapping.joints.items():
        for key, changes in own.items():
            place = f"joints.{joint}.{key}"
            if key not in mapping.signals:
                names = tuple(mapping.signals)
                faults.append(Fault(name, one_of(names, key), column=place))
                continue
            try:
                Signal.model_validate({**written(mapping.signals[key]), **changes})
            except ValidationError as error:
                inner = key_faults(name, error, PAGE, Signal)
                faults += [
                    Fault(name, fault.expected, None, f"{place}.{fault.column}", fault.value)
                    for fault in inner
                ]
    return faults


def _of_joint_column(mapping: Mapping, name: str) -> list[Fault]:
    """Return faults of columns of single joints, if a column names the joint of each row."""
    if mapping.joint_column is None:
        return []
    expected = "a column that all joints share, where joint_column stands"
    own = [
        f"joints.{joint}.{key}.column"
        for joint, signals in mapping.joints.items()
        for key, changes in signals.items()
        if "column" in changes
    ]
    own += [
        f"{key}.column" for key, signal in mapping.signals.items() if JOINT in str(signal.column)
    ]
    return [Fault(name, expected, column=place) for place in own]


def _of_signal(mapping: Mapping, name: str, place: str, key: str, signal: Signal) -> list[Fault]:
    units = SIGNALS[key]
    if signal.unit not in units:
        expected = one_of(tuple(units), signal.unit)
        return [Fault(name, expected, column=f"{place}.unit", value=signal.unit)]
    faults = []
    if needs_factor(signal.unit) and units is FORCES and signal.factor is None:
        what = "N·m" if mapping.rotary else "N"
        of_all = {"share": "all of the PWM", "%": "all of the PWM", "raw": "1"}
        of = of_all.get(signal.unit, f"1 {signal.unit.removeprefix('m')}")
        expected = f"{what} for {of}: the torque constant; a gear is gear_ratio"
        faults.append(Fault(name, expected, column=f"{place}.factor"))
    if signal.unit == "tick" and signal.factor is None and signal.counts_per_turn is None:
        expected = "counts of the encoder a turn, where unit is tick"
        faults.append(Fault(name, expected, column=f"{place}.counts_per_turn"))
    if signal.unit == "tick" and None not in (signal.factor, signal.counts_per_turn):
        expected = "counts_per_turn or a factor, not both: each says what a tick is"
        faults.append(Fault(name, expected, column=f"{place}.factor", value=f"{signal.factor:g}"))
    if signal.counts_per_turn is not None and signal.unit != "tick":
        expected = 'unit = "tick", where counts_per_turn stands'
        faults.append(Fault(name, expected, column=f"{place}.unit", value=signal.unit))
    is_of_force = units is FORCES and mapping.position.unit in LENGTHS
    wrong = (STRAIGHT if mapping.rotary else TORQUES) if is_of_force else {}
    if signal.unit in wrong and signal.factor is None:
        expected = (
            f"a torque, since position is in {mapping.position.unit}, or the lever in m as factor"
            if mapping.rotary
            else f"a force, since position is in {mapping.position.unit}, or 1/m as factor"
        )
        faults.append(Fault(name, expected, column=f"{place}.unit", value=signal.unit))
    if key == "position" and (signal.unit in ROTARY) != mapping.rotary:
        expected = (
            f"a unit as that of the other joints, {mapping.position.unit}: joints that turn and "
            "joints that slide are recordings of their own"
        )
        faults.append(Fault(name, expected, column=f"{place}.unit", value=signal.unit))
    if key == "command" and (signal.unit in ROTARY) != mapping.rotary:
        expected = f"a unit as that of the position, {mapping.position.unit}"
        faults.append(Fault(name, expected, column=f"{place}.unit", value=signal.unit))
    return faults


def _is_finite(value: object) -> bool:
    return isinstance(value, float) and math.isfinite(value)


def _of_runs(mapping: Mapping, name: str) -> list[Fault]:
    faults = [
        Fault(name, "to_s above from_s", column=f"runs.{run.name}", value=f"{run.to_s:g}")
        for run in mapping.runs
        if run.to_s is not None and run.to_s <= (run.from_s or 0.0)
    ]
    faults += [
        Fault(name, "a name that no spreadsheet takes for a formula", column="runs", value=text)
        for run in mapping.runs
        for text in (run.name, *(run.model_extra or ()))
        if text.startswith(FORMULA)
    ]
    faults += [
        Fault(name, "a number or a text", column=f"runs.{run.name}.{key}", value=str(value))
        for run in mapping.runs
        for key, value in (run.model_extra or {}).items()
        if not isinstance(value, str | int) and not _is_finite(value)
    ]
    names = [run.name for run in mapping.runs]
    faults += [
        Fault(name, "a different name for each run", column=f"runs.{run}")
        for run in dict.fromkeys(names)
        if names.count(run) > 1
    ]
    return faults

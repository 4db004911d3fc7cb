"""``mapping.toml``: which column of a log is what, in which unit, with which sign and gear."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Literal, get_args

from pydantic import (
    AliasChoices,
    BeforeValidator,
    ConfigDict,
    Field,
    FiniteFloat,
    ValidationError,
)

from bayesfric.docstrings import Documented
from bayesfric.errors import Fault, InputError, one_of
from bayesfric.files import key_faults, read_toml
from bayesfric.logs.units import (
    FORCES,
    LENGTHS,
    ROTARY,
    SPEEDS,
    STRAIGHT,
    TORQUES,
    needs_factor,
)
from bayesfric.recording.package import ForceIs

PAGE = "docs/howto/log.md"
FORMULA = ("=", "+", "-", "@", "\t", "\r")  # what begins one in a cell
FORCE_IS: tuple[str, ...] = get_args(ForceIs)
SIGNALS = {
    "position": LENGTHS,
    "force": FORCES,
    "measured_force": FORCES,
    "command": LENGTHS,
    "velocity": SPEEDS,
    "known_force": FORCES,
    "temperature": {"degC": 1.0},
}
"""What a mapping can say of a joint, and the units of each."""
JOINT = "{joint}"
SAY = "SAY"
"""What stands where a user has to say something; it is refused until it is replaced."""
Above = Annotated[float, Field(gt=0, allow_inf_nan=False)]


def _is_place(value: Any) -> Any:
    if isinstance(value, bool) or not isinstance(value, str | int):
        raise ValueError("the name of a column, or its number from 1")
    return value


Place = Annotated[str | int, BeforeValidator(_is_place)]


class _Section(Documented):
    model_config = ConfigDict(extra="forbid", frozen=True)


class CsvForm(_Section):
    """How a CSV is written.

    Fields
    ------
    separator: One character, "tab", or "space" for any blanks.
    header: Whether a line has the names of the columns.
    preamble: Lines before the header.
    unit_rows: Rows of units below the header.
    """

    separator: str = ","
    header: bool = True
    preamble: int = Field(0, ge=0, le=10_000)
    unit_rows: int = Field(0, ge=0, le=10)
    decimal: Literal[".", ","] = "."


class Time(_Section):
    """The clock.

    Fields
    ------
    rate_hz: In place of a column: samples a second.
    """

    column: Place | None = None
    unit: Literal["s", "ms", "us", "ns"] = "s"
    rate_hz: Above | None = None


class Signal(_Section):
    """One quantity of the joint.

    Fields
    ------
    column: Its name in the log, or its number from 1; {joint} stands for the joint's.
    time: A clock column of its own, in the same unit.
    unit: Of the column.
    gear_ratio: Turns of what the column is of, for one here.
    factor: A torque constant, say: what 1 of it is.
    counts_per_turn: Of an encoder, where unit is tick.
    force_is: Of a force.
    """

    column: Place
    time: Place | None = None
    unit: str
    sign: Literal[1, -1] = 1
    gear_ratio: Above = 1.0
    factor: Above | None = None
    counts_per_turn: Above | None = None
    force_is: ForceIs | None = Field(None, validation_alias=AliasChoices("force_is", "kind"))


class Run(_Section):
    """A piece of the log.

    Fields
    ------
    file: Name of the log's file, where there are several.
    value: Of the column of runs.
    from_s: Since the log's first sample.
    """

    model_config = ConfigDict(extra="allow", frozen=True)
    name: str
    file: str | None = None
    value: str | int | float | None = None
    from_s: FiniteFloat | None = None
    to_s: FiniteFloat | None = None
    role: Literal["calibrate", "test"] | None = None


class RobotModel(_Section):
    """The robot's own model, whose friction and armature are what the simulator has now.

    Fields
    ------
    model: A URDF or MJCF file in the folder of the mapping.
    joints: Joint of the log to its name there, where it differs.
    """

    model: str
    joints: dict[str, str] = Field(default_factory=dict)


class Mapping(_Section):
    """What the columns of a log are.

    Fields
    ------
    measured_force: Beside a commanded force: how late it is, is estimated from it.
    command: The commanded position.
    velocity: Checks the unit and sign of the position.
    known_force: By the user's rigid-body model.
    joints: What is another for a joint: joints.elbow.force.sign.
    run: A column: each value of it is a run.
    """

    csv: CsvForm | None = None
    time: Time = Time(column="time_s")
    position: Signal
    force: Signal | None = None
    measured_force: Signal | None = None
    command: Signal | None = None
    velocity: Signal | None = None
    known_force: Signal | None = None
    temperature: Signal | None = None
    joints: dict[str, dict[str, dict[str, Any]]] = Field(default_factory=dict)
    run: Place | None = None
    runs: tuple[Run, ...] = ()
    encoder_resolution: Above | None = None
    moving_mass: Above | None = None
    other_joints: Literal["still", "logged", "moving", "unknown"] | None = None
    robot: RobotModel | None = None

    @property
    def rotary(self) -> bool:
        """Whether the joint turns."""
        return self.position.unit in ROTARY

    @property
    def signals(self) -> dict[str, Signal]:
        """What it says of a joint, by name of the signal."""
        signals = {name: getattr(self, name) for name in SIGNALS}
        return {name: signal for name, signal in signals.items() if signal is not None}

    @property
    def is_of_any_joint(self) -> bool:
        """Whether its columns have a place for the name of a joint."""
        return any(JOINT in str(signal.column) for signal in self.signals.values())

    def of_joint(self, joint: str | None) -> dict[str, Signal]:
        """Return the signals of a joint, with what is another for it."""
        own = self.joints.get(joint or "", {})
        signals = {
            name: Signal.model_validate({**_written(signal), **own.get(name, {})})
            for name, signal in self.signals.items()
        }
        if joint is None:
            return signals
        return {
            name: signal.model_copy(
                update={
                    "column": _with_joint(signal.column, joint),
                    "time": _with_joint(signal.time, joint),
                }
            )
            for name, signal in signals.items()
        }

    def clock_of(self, signal: Signal) -> str | int | None:
        """Return the column of a signal's clock; None where a rate stands for it."""
        return self.time.column if signal.time is None else signal.time


def scale_of(name: str, signal: Signal) -> float:
    """Return what a value of a signal's column is multiplied by."""
    scale = signal.sign * (1.0 if signal.factor is None else signal.factor)
    if name in ("position", "command", "velocity"):
        scale = scale * SIGNALS[name][signal.unit] / signal.gear_ratio
        if signal.counts_per_turn is not None:
            scale *= 2 * math.pi / signal.counts_per_turn
        return scale
    return scale * SIGNALS[name][signal.unit] * signal.gear_ratio


def _written(signal: Signal) -> dict[str, Any]:
    return signal.model_dump(exclude_unset=True)


def _with_joint(column: str | int | None, joint: str) -> str | int | None:
    return column.replace(JOINT, joint) if isinstance(column, str) else column


def read_mapping(path: Path) -> Mapping:
    """Return the mapping of a file.

    Raises
    ------
    InputError
        With every fault of it.
    """
    return checked_mapping(read_toml(path), path.name)


def checked_mapping(keys: dict[str, Any], name: str) -> Mapping:
    """Return a mapping from its keys; `name` is what an error calls them."""
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


def _unsaid(keys: dict[str, Any], name: str, before: str = "") -> Iterator[Fault]:
    """Yield a fault for each place of a proposal that was not edited."""
    for key, value in keys.items():
        if isinstance(value, dict):
            yield from _unsaid(value, name, f"{before}{key}.")
        elif value == SAY:
            expected = "what is right, which the log does not say"
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
        expected = "another separator than a comma, where decimals have one"
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
    faults = []
    for joint, own in mapping.joints.items():
        for key, changes in own.items():
            place = f"joints.{joint}.{key}"
            if key not in mapping.signals:
                names = tuple(mapping.signals)
                faults.append(Fault(name, one_of(names, key), column=place))
                continue
            try:
                Signal.model_validate({**_written(mapping.signals[key]), **changes})
            except ValidationError as error:
                inner = key_faults(name, error, PAGE, Signal)
                faults += [
                    Fault(name, fault.expected, None, f"{place}.{fault.column}", fault.value)
                    for fault in inner
                ]
    return faults


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
        Fault(name, "a name of its own for each run", column=f"runs.{run}")
        for run in dict.fromkeys(names)
        if names.count(run) > 1
    ]
    return faults

"""``mapping.toml``: the meaning, unit, sign and gear ratio of the columns of a log."""

import math
from typing import Annotated, Any, Literal, get_args

from pydantic import (
    AliasChoices,
    BeforeValidator,
    ConfigDict,
    Field,
    FiniteFloat,
)

from bayesfric.docstrings import Documented
from bayesfric.logs.units import (
    FORCES,
    LENGTHS,
    ROTARY,
    SPEEDS,
)
from bayesfric.recording.package import ForceIs

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
"""Signals of a joint in a mapping, and the units of each."""
JOINT = "{joint}"
SAY = "SAY"
"""Placeholder for a value that the user must give; it is refused until it is replaced."""
Above = Annotated[float, Field(gt=0, allow_inf_nan=False)]


def _is_place(value: Any) -> Any:
    if isinstance(value, bool) or not isinstance(value, str | int):
        raise ValueError("the name of a column, or its number from 1")
    return value


Place = Annotated[str | int, BeforeValidator(_is_place)]


class _Section(Documented):
    model_config = ConfigDict(extra="forbid", frozen=True)


class CsvForm(_Section):
    """The format of a CSV file.

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
    rate_hz: Samples per second, instead of a column.
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
    unit: Unit of the column.
    gear_ratio: Turns of the recorded shaft for one turn of the joint.
    factor: Value of one unit of the column, such as a torque constant.
    counts_per_turn: Counts per turn of an encoder, if the unit is tick.
    force_is: Kind of a force.
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
    file: Name of the log's file, if there are several.
    value: Value in the column of runs.
    from_s: Begin, since the log's first sample.
    """

    model_config = ConfigDict(extra="allow", frozen=True)
    name: str
    file: str | None = None
    value: str | int | float | None = None
    from_s: FiniteFloat | None = None
    to_s: FiniteFloat | None = None
    role: Literal["calibrate", "test"] | None = None


class RobotModel(_Section):
    """The robot's own model, with the simulator's present friction and armature.

    Fields
    ------
    model: A URDF or MJCF file in the folder of the mapping.
    joints: Name in the model by joint of the log, if it differs.
    """

    model: str
    joints: dict[str, str] = Field(default_factory=dict)


class Mapping(_Section):
    """The meaning of the columns of a log.

    Fields
    ------
    measured_force: Measured force beside a commanded one; its delay is estimated.
    command: The commanded position.
    velocity: Checks the unit and sign of the position.
    known_force: Force by the user's rigid-body model.
    joints: Keys that differ for a joint, such as joints.elbow.force.sign.
    run: A column; each of its values is a run.
    encoder_resolution: Resolution of the position of each imported joint.
    moving_mass: Moving mass of a joint that is imported alone.
    joint_column: A column that names the joint of each row, if all joints share the other columns.
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
    joint_column: Place | None = None
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
        """Its signals of a joint, by name."""
        signals = {name: getattr(self, name) for name in SIGNALS}
        return {name: signal for name, signal in signals.items() if signal is not None}

    @property
    def is_of_any_joint(self) -> bool:
        """Whether its columns have a placeholder for the name of a joint."""
        return any(JOINT in str(signal.column) for signal in self.signals.values())

    def of_joint(self, joint: str | None) -> dict[str, Signal]:
        """Return the signals of a joint, with the keys that differ for it."""
        own = self.joints.get(joint or "", {})
        signals = {
            name: Signal.model_validate({**written(signal), **own.get(name, {})})
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
        """Return the column of a signal's clock; None if there is a rate instead."""
        return self.time.column if signal.time is None else signal.time


def scale_of(name: str, signal: Signal) -> float:
    """Return the factor on the values of a signal's column."""
    scale = signal.sign * (1.0 if signal.factor is None else signal.factor)
    if name in ("position", "command", "velocity"):
        scale = scale * SIGNALS[name][signal.unit] / signal.gear_ratio
        if signal.counts_per_turn is not None:
            scale *= 2 * math.pi / signal.counts_per_turn
        return scale
    return scale * SIGNALS[name][signal.unit] * signal.gear_ratio


def written(signal: Signal) -> dict[str, Any]:
    """Return the keys of a signal that differ from the defaults."""
    return signal.model_dump(exclude_unset=True)


def _with_joint(column: str | int | None, joint: str) -> str | int | None:
    return column.replace(JOINT, joint) if isinstance(column, str) else column

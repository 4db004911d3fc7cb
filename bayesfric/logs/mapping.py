"""``mapping.toml``: which column of a log is what, in which unit, with which sign and gear."""

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from bayesfric.errors import Fault, InputError
from bayesfric.files import read_toml

__all__ = ["Mapping", "Run", "Signal", "Time", "read_mapping"]

SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
LENGTHS = {"m": 1.0, "mm": 1e-3, "rad": 1.0, "deg": 0.017453292519943295, "turn": 6.283185307179586}
FORCES = {"N": 1.0, "N·m": 1.0, "Nm": 1.0, "mNm": 1e-3, "A": 1.0}
FORMULA = ("=", "+", "-", "@", "\t", "\r")  # what begins one in a cell
ROTARY = {"rad", "deg", "turn"}
Above = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Time(_Section):
    """The clock."""

    column: str
    unit: Literal["s", "ms", "us", "ns"] = "s"


class Signal(_Section):
    """One quantity of the joint."""

    column: str = Field(description="Its name in the log; {joint} stands for the joint's.")
    time: str | None = Field(None, description="A clock column of its own, in the same unit.")
    unit: str = Field(description="Of the column.")
    sign: Literal[1, -1] = 1
    gear_ratio: Above = Field(1.0, description="Turns of what the column is of, for one here.")
    factor: Above = Field(1.0, description="A torque constant, say: what 1 of the column is.")
    kind: Literal["commanded", "measured"] = "commanded"


class Run(_Section):
    """A piece of the log."""

    model_config = ConfigDict(extra="allow", frozen=True)
    name: str
    from_s: float = Field(description="Since the log's first sample.")
    to_s: float
    role: Literal["calibrate", "test"] | None = None


class Mapping(_Section):
    """What the columns of a log are."""

    time: Time = Time(column="time_s")
    position: Signal
    force: Signal
    measured_force: Signal | None = Field(
        None, description="Beside a commanded force: how late it is, is estimated from it."
    )
    runs: tuple[Run, ...] = ()
    encoder_resolution: Above | None = None
    moving_mass: Above | None = None

    @property
    def rotary(self) -> bool:
        """Whether the joint turns."""
        return self.position.unit in ROTARY

    def scale(self, name: str, signal: Signal) -> float:
        """Return what a value of a column is multiplied by."""
        if name == "position":
            return signal.sign * signal.factor * LENGTHS[signal.unit] / signal.gear_ratio
        return signal.sign * signal.factor * FORCES[signal.unit] * signal.gear_ratio


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
        found = Mapping.model_validate(keys)
    except ValidationError as error:
        raise InputError(
            [
                Fault(name, one["msg"], column=".".join(map(str, one["loc"])))
                for one in error.errors()
            ]
        ) from error
    signals = {"position": (found.position, LENGTHS), "force": (found.force, FORCES)}
    if found.measured_force is not None:
        signals["measured_force"] = (found.measured_force, FORCES)
    faults = [
        Fault(name, f"one of {', '.join(known)}", column=f"{key}.unit", value=one.unit)
        for key, (one, known) in signals.items()
        if one.unit not in known
    ]
    faults += [
        Fault(name, "to_s above from_s", column=f"runs.{run.name}", value=f"{run.to_s:g}")
        for run in found.runs
        if run.to_s <= run.from_s
    ]
    faults += [
        Fault(name, "a name that no spreadsheet takes for a formula", column="runs", value=text)
        for run in found.runs
        for text in (run.name, *(run.model_extra or ()))
        if text.startswith(FORMULA)
    ]
    if faults:
        raise InputError(faults)
    return found

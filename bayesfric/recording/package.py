"""``datapackage.json`` → what the reader needs of it, with every fault."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime
from pathlib import PurePosixPath, PureWindowsPath
from typing import Annotated, Any, Literal, TypeVar

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, ValidationError

from bayesfric.characters import invisible_in
from bayesfric.errors import Fault, near
from bayesfric.recording.columns import LARGEST, LARGEST_INTEGER, LONGEST_NAME
from bayesfric.recording.csv_text import LISTED, with_rest
from bayesfric.recording.json_text import dotted, parse_json_object, shown
from bayesfric.recording.tables import STANDARD_GRAVITY, Pulley, RigConstants, Robot

PACKAGE_FILE = "datapackage.json"
ForceIs = Literal["commanded", "motor", "link", "measured", "unknown"]

# Properties of the Data Package standard, and one of bayesfric, that are kept as written.
KEPT = (
    "$schema",
    "id",
    "profile",
    "description",
    "homepage",
    "version",
    "keywords",
    "licenses",
    "sources",
    "contributors",
    "image",
    "simulation",
    "import_notes",
)

OWN = ("name", "title", "created", "resources", "rig", *KEPT)

# Error type of pydantic → what was expected.
EXPECTED = {
    "missing": "this key",
    "string_type": "text",
    "string_pattern_mismatch": "text that is not blank",
    "float_type": "a number",
    "int_type": "an integer",
    "bool_type": "true or false, in small letters without quotation marks",
    "list_type": "a list",
    "too_short": "a list of at least {min_length}",
    "too_long": "a list of at most {max_length}",
    "dict_type": "an object",
    "model_type": "an object",
    "model_attributes_type": "an object",
    "greater_than": "a number above {gt:g}",
    "greater_than_equal": "a number of at least {ge:g}",
    "less_than_equal": "a number of at most {le:g}",
    "literal_error": "{expected}",
    "value_error": "{error}",
}


Number = TypeVar("Number", int, float)


def _whole(value: Any) -> Any:
    """Accept 5.0 as an integer, since JSON has one kind of number."""
    return int(value) if isinstance(value, float) and value.is_integer() else value


def _ordered(value: list[Number]) -> list[Number]:
    if value[0] > value[1]:
        raise ValueError("[low, high] with low not above high")
    return value


def _iso8601(value: str) -> str:
    try:
        datetime.fromisoformat(value)
        if not re.fullmatch(r"[0-9W:+.,TtZz -]+", value):  # Python accepts any separator
            raise ValueError
    except ValueError:
        raise ValueError("an ISO 8601 date or time such as 2026-11-01T00:00:00Z") from None
    return value


def _inside(path: str) -> str:
    leaves = path.startswith("/") or PureWindowsPath(path).drive or "://" in path
    if leaves or "\\" in path or "\0" in path or ".." in PurePosixPath(path).parts:
        raise ValueError("a relative path, with /, that stays in the folder of the recording")
    return PurePosixPath(path).as_posix()


def _model_file(path: str) -> str:
    if PurePosixPath(path).suffix.lower() not in (".urdf", ".xml", ".mjcf"):
        raise ValueError("a file of URDF or MJCF: .urdf, .xml or .mjcf")
    return path


def _at_most(bound: float, unit: str, mistake: str) -> AfterValidator:
    def check(value: float) -> float:
        if value > bound:
            raise ValueError(f"a number of at most {bound:g} {unit} (is it in {mistake}?)")
        return value

    return AfterValidator(check)


def _seen(name: str) -> str:
    if len(name) > LONGEST_NAME:
        raise ValueError(f"text of at most {LONGEST_NAME} characters that can be seen")
    return _legible(name)


def _legible(name: str) -> str:
    if unseen := invisible_in(name):
        raise ValueError(f"text that can be seen{unseen}")
    return name


Positive = Annotated[float, Field(gt=0, le=LARGEST)]
Length = Annotated[float, Field(gt=0), _at_most(2.0, "m", "millimetres")]
Mass = Annotated[float, Field(gt=0), _at_most(10.0, "kg", "grams")]
Resolution = Annotated[float, Field(gt=0), _at_most(0.5, "s", "milliseconds or microseconds")]
ClockOffset = Annotated[float, Field(ge=0), _at_most(1.0, "s", "milliseconds or microseconds")]
Step = Annotated[float, Field(gt=0), _at_most(2.0, "m or rad", "millimetres or degrees")]
Share = Annotated[float, Field(gt=0), _at_most(1.0, "times the force", "percent")]
Delay = Annotated[float, Field(ge=0), _at_most(2.0, "s", "milliseconds or microseconds")]
Gravity = Annotated[float, Field(ge=0), _at_most(100.0, "m/s²", "mm/s²")]
Count = Annotated[int, BeforeValidator(_whole), Field(ge=1, le=LARGEST_INTEGER)]
NotNegative = Annotated[float, Field(ge=0, le=LARGEST)]
Speed = Annotated[float, Field(ge=-LARGEST, le=LARGEST)]
Angle = Annotated[float, Field(ge=0, le=180)]
Text = Annotated[str, Field(pattern=r"\S")]
Name = Annotated[Text, AfterValidator(_seen)]
Pair = Annotated[list[Number], Field(min_length=2, max_length=2), AfterValidator(_ordered)]


class _Strict(BaseModel):
    model_config = ConfigDict(strict=True, allow_inf_nan=False)


class _Header(_Strict):
    name: Annotated[Text, AfterValidator(_legible)]
    title: Text
    created: Annotated[str, AfterValidator(_iso8601)] | None = None
    import_notes: list[Text] | None = None


class _Resource(_Strict):
    name: Text
    path: Annotated[Text, AfterValidator(_inside)]


class _Pulley(_Strict):
    radius_m: Length | None = None
    mass_kg: Mass | None = None


class _Limits(_Strict):
    travel_m: Pair[NotNegative] | None = None
    tension_n: Pair[NotNegative] | None = None
    velocity_m_s: Pair[Speed] | None = None
    n_pulleys: Pair[Count] | None = None
    wrap_angle_deg: Pair[Angle] | None = None
    masses_kg: list[Positive] | None = None


class _Robot(_Strict):
    model: Annotated[Text, AfterValidator(_inside), AfterValidator(_model_file)]
    joints: Annotated[dict[Name, Text], Field(min_length=1)]


class _Rig(_Strict):
    gravity_m_s2: Gravity | None = None
    hall_spacing_m: Length | None = None
    magnets_per_revolution: Count | None = None
    timer_resolution_s: Resolution | None = None
    sensor_clock_sd_s: ClockOffset | None = None
    motor_torque_constant_n_m_per_a: Positive | None = None
    capstan_radius_m: Length | None = None
    pulleys: dict[Name, _Pulley] | None = None
    limits: _Limits | None = None
    moving_mass_kg: Positive | None = None
    mass_sd_kg: Positive | None = None
    encoder_resolution: Step | None = None
    force_is: ForceIs | None = None
    robot: _Robot | None = None
    other_joints: Literal["still", "logged", "moving", "unknown"] | None = None
    force_gain_sd: Share | None = None
    known_force_sd: Positive | None = None
    command_gain: Positive | None = None
    force_limit_n: Positive | None = None
    payload_arm_m: Length | None = None
    sample_hold_s: Resolution | None = None
    latency_s: Delay | None = None
    rotary: bool | None = None


@dataclass(frozen=True)
class Resource:
    """One entry of ``resources``.

    Parameters
    ----------
    name, path : str
        As written; the path is normalised.
    place : str
        Dotted key of the entry.
    sound : bool
        False if the path is faulty and must not be opened.
    """

    name: str
    path: str
    place: str
    sound: bool = True


@dataclass(frozen=True)
class Package:
    """``datapackage.json``, as far as it could be read.

    Parameters
    ----------
    name, title, created, metadata
        As in :class:`~bayesfric.recording.tables.Recording`.
    rig : RigConstants
        Faulty keys are left out.
    rig_keys : frozenset of str
        Keys of ``rig`` in the file, valid or not.
    resources : tuple of Resource
        Resources that name a table, by name or by path.
    faults, notes : tuple
        Faults, and notes on what is ignored.
    """

    name: str
    title: str
    created: str | None
    metadata: Mapping[str, Any]
    rig: RigConstants
    rig_keys: frozenset[str]
    resources: tuple[Resource, ...]
    faults: tuple[Fault, ...]
    notes: tuple[str, ...]


def fault_of_key(key: str, expected: str, value: str | None = None) -> Fault:
    """Return a fault of ``datapackage.json`` at a dotted key."""
    return Fault(PACKAGE_FILE, expected, column=key, value=value)


def parse_package(data: bytes) -> Package:
    """Read the bytes of ``datapackage.json``.

    Raises
    ------
    InputError
        If the bytes are no JSON object. All other faults are collected in the result.
    """
    content, faults = parse_json_object(PACKAGE_FILE, data)
    header = _checked(_Header, content, (), faults)
    raw_rig = content.get("rig", {})
    if not isinstance(raw_rig, dict):
        faults.append(fault_of_key("rig", "an object", shown(raw_rig)))
        raw_rig = {}
    rig = _rig(_checked(_Rig, raw_rig, ("rig",), faults))
    unknown = [key for key in content if key not in OWN] + _unknown_rig_keys(raw_rig)
    return Package(
        name=header.get("name", ""),
        title=header.get("title", ""),
        created=header.get("created"),
        metadata={key: content[key] for key in content if key in KEPT},
        rig=rig,
        rig_keys=frozenset(key for key, value in raw_rig.items() if value is not None),
        resources=_resources(content, faults),
        faults=tuple(_folded(faults)),
        notes=(*header.get("import_notes", ()), *_notes(unknown)),
    )


def _folded(faults: list[Fault]) -> list[Fault]:
    """Return the first faults of each kind; the last of them counts the rest."""
    kinds: dict[str, list[Fault]] = {}
    for fault in faults:
        kinds.setdefault(fault.expected, []).append(fault)
    return [
        fault
        for faults_of_kind in kinds.values()
        for fault in with_rest(faults_of_kind[:LISTED], len(faults_of_kind[LISTED:]))
    ]


def _notes(unknown: list[str]) -> Iterator[str]:
    known_keys = [*OWN, *(f"rig.{key}" for key in _Rig.model_fields)]
    for key in unknown[:LISTED]:
        yield f"{PACKAGE_FILE}: unknown key {key} kept out{near(key, known_keys)}"
    if len(unknown) > LISTED:
        yield f"{PACKAGE_FILE}: and {len(unknown) - LISTED:,} unknown keys more kept out"


def _checked(
    model: type[_Strict], raw: Any, place: tuple[str | int, ...], faults: list[Fault]
) -> dict[str, Any]:
    """Return the keys of `raw` that obey the model; add a fault for each other key."""
    try:
        return model.model_validate(raw).model_dump(exclude_none=True)
    except ValidationError as error:
        errors = error.errors(include_url=False)
    for problem in errors:
        if problem["type"] in ("finite_number", "string_unicode"):  # reported by parse_json_object
            continue
        rule = EXPECTED.get(problem["type"])
        expected = rule.format_map(problem.get("ctx", {})) if rule else problem["msg"]
        value = None if problem["type"] == "missing" else shown(problem["input"])
        key = dotted((*place, *(part for part in problem["loc"] if part != "[key]")))
        faults.append(fault_of_key(key, expected, value))
    wrong = {problem["loc"][0] for problem in errors if problem["loc"]}
    if not wrong or not isinstance(raw, dict):
        return {}
    good = {key: raw[key] for key in model.model_fields if key in raw and key not in wrong}
    return (
        good
        if "missing" in {problem["type"] for problem in errors}
        else _checked(model, good, place, [])
    )


def _rig(keys: dict[str, Any]) -> RigConstants:
    pulleys = {size: Pulley(**pulley) for size, pulley in keys.pop("pulleys", {}).items()}
    gravity = keys.pop("gravity_m_s2", STANDARD_GRAVITY)
    robot = Robot(**keys.pop("robot")) if "robot" in keys else None
    return RigConstants(gravity_m_s2=gravity, pulleys=pulleys, robot=robot, **keys)


def _resources(content: dict[str, Any], faults: list[Fault]) -> tuple[Resource, ...]:
    raw = content.get("resources")
    if not isinstance(raw, list):
        value = shown(raw) if "resources" in content else None
        faults.append(fault_of_key("resources", "a list of the recording's tables", value))
        return ()
    resources: list[Resource] = []
    names: set[str] = set()
    for index, entry in enumerate(raw):
        place = ("resources", index)
        keys = _checked(_Resource, entry, place, faults)
        if isinstance(entry, dict):
            # A faulty resource still says which table it is.
            name, path = (keys.get(key, entry.get(key)) for key in ("name", "path"))
            sound = "path" in keys
            resources.append(Resource(shown(name), shown(path), dotted(place), sound))
            if "name" in keys and name in names:
                key, expected = dotted((*place, "name")), "a name that no other resource has"
                faults.append(fault_of_key(key, expected, shown(name)))
            names.add(shown(name))
    return tuple(resources)


def _unknown_rig_keys(rig: dict[str, Any]) -> list[str]:
    unknown = [f"rig.{key}" for key in rig if key not in _Rig.model_fields]
    limits = rig.get("limits")
    if isinstance(limits, dict):
        unknown += [f"rig.limits.{key}" for key in limits if key not in _Limits.model_fields]
    pulleys = rig.get("pulleys")
    for size, pulley in pulleys.items() if isinstance(pulleys, dict) else ():
        if isinstance(pulley, dict):
            keys = [key for key in pulley if key not in _Pulley.model_fields]
            unknown += [f"rig.pulleys.{size}.{key}" for key in keys]
    robot = rig.get("robot")
    if isinstance(robot, dict):
        unknown += [f"rig.robot.{key}" for key in robot if key not in _Robot.model_fields]
    return unknown

"""``datapackage.json``: every rule broken once, and what is kept out."""

import json
from pathlib import Path
from typing import Any

import pytest
from recording.mini import Mini

from bayesfric.errors import InputError
from bayesfric.recording import Pulley, read_recording

PACKAGE, STEADY = "datapackage.json", "steady_friction.csv"
HUGE = 10**400


def faults_of_json(tmp_path: Path, text: str | bytes) -> list[tuple[Any, ...]]:
    folder = Mini().keep(STEADY).write(tmp_path)
    (folder / PACKAGE).write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(InputError) as caught:
        read_recording(folder)
    assert all(fault.file == PACKAGE for fault in caught.value.faults)
    return [(f.row, f.column, f.value, f.expected) for f in caught.value.faults]


def with_value(dotted: str, value: Any) -> str:
    package: dict[str, Any] = Mini().keep(STEADY).package
    place: Any = package
    *parents, last = dotted.split(".")
    for key in parents:
        place = place[int(key) if isinstance(place, list) else key]
    place[int(last) if isinstance(place, list) else last] = value
    return json.dumps(package)


@pytest.mark.parametrize(
    ("text", "row", "column", "value", "rule"),
    [
        ("", 1, None, None, "JSON"),
        ('{\n"name": x}', 2, None, "x}", "JSON"),
        ("[1]", None, None, "[1]", "a JSON object"),
        ("3", None, None, "3", "a JSON object"),
        ('{"a": ' * 200_000 + "1" + "}" * 200_000, None, None, None, "not nested so deeply"),
        ('{"a": ' + "9" * 5000 + "}", None, None, None, "reasonable length"),
        (b'{"name": "\xe9"}', 1, None, "byte 0xe9", "UTF-8"),
        (b'{"name": "\x00"}', 1, None, "byte 0x00", "NUL"),
    ],
)
def test_json_that_does_not_parse(
    tmp_path: Path, text: str | bytes, row: int, column: str, value: str, rule: str
) -> None:
    (fault,) = faults_of_json(tmp_path, text)
    assert fault[:3] == (row, column, value)
    assert rule in fault[3]


POSITIVE = (
    "hall_spacing_m",
    "timer_resolution_s",
    "motor_torque_constant_n_m_per_a",
    "capstan_radius_m",
    "moving_mass_kg",
    "encoder_resolution",
    "pulleys.wide.radius_m",
    "pulleys.wide.mass_kg",
)


@pytest.mark.parametrize("key", POSITIVE)
@pytest.mark.parametrize("value", [0, -0.1, "0.01", True, [1], {}, HUGE])
def test_constant_that_is_no_positive_number(tmp_path: Path, key: str, value: Any) -> None:
    (fault,) = faults_of_json(tmp_path, with_value(f"rig.{key}", value))
    shown = value if isinstance(value, str) else json.dumps(value)
    assert fault[1:3] == (f"rig.{key}", shown)
    assert fault[3] in ("a number", "a number above 0")


@pytest.mark.parametrize("value", [-0.1, "0.01", True, HUGE])
def test_gravity_is_no_number_below_zero(tmp_path: Path, value: Any) -> None:
    """None may act: whether a table can be without it is asked where that is read."""
    (fault,) = faults_of_json(tmp_path, with_value("rig.gravity_m_s2", value))
    assert fault[1] == "rig.gravity_m_s2"
    assert fault[3] in ("a number", "a number of at least 0")


@pytest.mark.parametrize("literal", ["NaN", "Infinity", "-Infinity", "1e999"])
@pytest.mark.parametrize("key", ["rig.hall_spacing_m", "simulation", "unknown"])
def test_number_that_is_not_finite(tmp_path: Path, literal: str, key: str) -> None:
    text = with_value(key, "@").replace('"@"', literal)
    (fault,) = faults_of_json(tmp_path, text)
    value = "Infinity" if literal == "1e999" else literal
    assert fault[1:] == (key, value, "a finite number")


@pytest.mark.parametrize(
    ("key", "value", "rule"),
    [
        ("name", "", "not blank"),
        ("name", 3, "text"),
        ("title", " ", "not blank"),
        ("title", None, "text"),
        ("created", "yesterday", "ISO 8601"),
        ("created", "2026-13-01", "ISO 8601"),
        ("created", "2026-11-01x00:00", "ISO 8601"),
        ("created", 2026, "text"),
        ("rig", [], "an object"),
        ("rig", None, "an object"),
        ("rig.magnets_per_revolution", 0, "at least 1"),
        ("rig.magnets_per_revolution", 4.5, "an integer"),
        ("rig.magnets_per_revolution", "5", "an integer"),
        ("rig.moving_mass_kg", 1e300, "at most 1e+12"),
        ("rig.force_limit_n", 1e13, "at most 1e+12"),
        ("rig.rotary", 1, "true or false"),
        ("rig.force_is", "guessed", "'commanded', 'motor', 'link', 'measured' or 'unknown'"),
        ("rig.pulleys", [], "an object"),
        ("rig.pulleys.wide", 0.02, "an object"),
        ("rig.limits", [0, 1], "an object"),
        ("resources", {}, "a list"),
        ("resources.0", "steady_friction.csv", "an object"),
    ],
)
def test_wrong_value(tmp_path: Path, key: str, value: Any, rule: str) -> None:
    fault = faults_of_json(tmp_path, with_value(key, value))[0]
    shown = value if isinstance(value, str) else json.dumps(value)
    assert fault[1:3] == (key.replace(".0", "[0]"), shown)
    assert rule in fault[3]


@pytest.mark.parametrize(
    ("key", "value", "column"),
    [
        ("travel_m", [1.2, 0], "travel_m"),
        ("travel_m", [-1, 0], "travel_m[0]"),
        ("tension_n", [0], "tension_n"),
        ("tension_n", [0, 1e300], "tension_n[1]"),
        ("velocity_m_s", [-1e300, 0], "velocity_m_s[0]"),
        ("velocity_m_s", [0, 1, 2], "velocity_m_s"),
        ("n_pulleys", [0, 9], "n_pulleys[0]"),
        ("wrap_angle_deg", [15, 181], "wrap_angle_deg[1]"),
        ("masses_kg", [1, 0], "masses_kg[1]"),
        ("masses_kg", 1, "masses_kg"),
    ],
)
def test_wrong_limit(tmp_path: Path, key: str, value: Any, column: str) -> None:
    (fault,) = faults_of_json(tmp_path, with_value(f"rig.limits.{key}", value))
    assert fault[1] == f"rig.limits.{column}"


@pytest.mark.parametrize("key", ["name", "title", "resources"])
def test_missing_key(tmp_path: Path, key: str) -> None:
    package = Mini().keep(STEADY).package
    del package[key]
    (fault,) = faults_of_json(tmp_path, json.dumps(package))
    assert fault[:3] == (None, key, None)


@pytest.mark.parametrize("key", ["name", "path"])
def test_missing_key_of_a_resource(tmp_path: Path, key: str) -> None:
    package = Mini().keep(STEADY).package
    del package["resources"][0][key]
    (fault,) = faults_of_json(tmp_path, json.dumps(package))
    assert fault[1:3] == (f"resources[0].{key}", None)


def test_resources_that_repeat(tmp_path: Path) -> None:
    package = Mini().keep(STEADY).package
    package["resources"] += [
        {"name": "steady-friction", "path": "other.csv"},
        {"name": "again", "path": STEADY},
    ]
    assert [fault[1:3] for fault in faults_of_json(tmp_path, json.dumps(package))] == [
        ("resources[1].name", "steady-friction"),
        ("resources[1].path", "other.csv"),
        ("resources[2].path", STEADY),
    ]


def test_key_without_a_name_can_be_told(tmp_path: Path) -> None:
    text = json.dumps(Mini().keep(STEADY).package)[:-1] + ', "": NaN}'
    (fault,) = faults_of_json(tmp_path, text)
    assert fault[1:3] == ('""', "NaN")


def test_key_that_repeats(tmp_path: Path) -> None:
    text = json.dumps(Mini().keep(STEADY).package)[:-1] + ', "rig": {}}'
    (fault,) = faults_of_json(tmp_path, text)
    assert fault[1:3] == ("rig", "rig")
    assert "once only" in fault[3]


@pytest.mark.parametrize("where", ["name", "simulation", "unknown"])
def test_text_that_is_not_unicode(tmp_path: Path, where: str) -> None:
    """JSON may escape half a surrogate pair, which nothing could print or write."""
    (fault,) = faults_of_json(tmp_path, with_value(where, "\ud800"))
    assert fault[1:] == (where, "\\ud800", "Unicode text")


def test_all_faults_of_the_json_together(tmp_path: Path) -> None:
    package = Mini().keep(STEADY).package
    package["created"] = "now"
    package["rig"] |= {"gravity_m_s2": "g", "rotary": "no", "limits": {"travel_m": 3}}
    package["resources"].append({"name": 4, "path": "../x"})
    faults = faults_of_json(tmp_path, json.dumps(package))
    assert [place[1] for place in faults] == [
        "created",
        "rig.gravity_m_s2",
        "rig.limits.travel_m",
        "rig.rotary",
        "resources[1].name",
        "resources[1].path",
    ]


def test_what_is_kept(tmp_path: Path) -> None:
    mini = Mini()
    mini.package |= {"simulation": {"effects": ["viscous"]}, "sources": [{"title": "us"}]}
    mini.package["rig"]["magnets_per_revolution"] = 5.0
    recording = read_recording(mini.write(tmp_path))
    assert (recording.name, recording.title) == ("mini", "A small recording")
    assert recording.created == "2026-11-01T00:00:00Z"
    assert dict(recording.metadata) == {
        "licenses": [{"name": "CC0-1.0"}],
        "simulation": {"effects": ["viscous"]},
        "sources": [{"title": "us"}],
    }
    rig = recording.rig
    assert rig.gravity_m_s2 == 9.81
    assert rig.pulleys == {"wide": Pulley(radius_m=0.02, mass_kg=0.01)}
    assert rig.limits == {"travel_m": [0, 1.2], "n_pulleys": [1, 19], "masses_kg": [0.5, 1.0]}
    assert (rig.moving_mass_kg, rig.force_is, rig.rotary) == (0.4, "measured", False)
    assert rig.magnets_per_revolution == 5
    assert isinstance(rig.magnets_per_revolution, int)


def test_rig_may_be_absent_where_no_table_needs_it(tmp_path: Path) -> None:
    mini = Mini().keep(STEADY)
    del mini.package["rig"]
    assert read_recording(mini.write(tmp_path)).rig.gravity_m_s2 == 9.80665


@pytest.mark.parametrize(
    "created", ["2026-11-01", "2026-11-01T00:00:00+01:00", "2026-11-01 10:00:00.5Z", "20261101T10"]
)
def test_dates_of_iso_8601(tmp_path: Path, created: str) -> None:
    mini = Mini().keep(STEADY)
    mini.package["created"] = created
    assert read_recording(mini.write(tmp_path)).created == created


def test_unknown_keys_are_notes(tmp_path: Path) -> None:
    mini = Mini()
    mini.package["weather"] = "fine"
    mini.package["rig"] |= {"colour": "red", "limits": {"noise": 1}}
    mini.package["rig"]["pulleys"]["wide"]["colour"] = "blue"
    mini.package["resources"].append({"name": "photo", "path": "photo.jpg"})
    recording = read_recording(mini.write(tmp_path))
    text = "\n".join(recording.notes)
    for part in ("weather", "rig.colour", "rig.limits.noise", "rig.pulleys.wide.colour", "'photo'"):
        assert part in text
    assert len(recording.notes) == 6  # one is of the axis, as ever
    assert "weather" not in recording.metadata


def test_table_that_is_not_listed_is_a_note(tmp_path: Path) -> None:
    folder = Mini().write(tmp_path)
    mini = Mini().keep(STEADY)
    (folder / PACKAGE).write_bytes(mini.contents()[PACKAGE])
    notes = read_recording(folder).notes
    assert len(notes) == 6
    assert all("no resource of datapackage.json" in note for note in notes)


def test_table_schema_is_tolerated(tmp_path: Path) -> None:
    mini = Mini().keep(STEADY)
    mini.package["resources"][0]["schema"] = {"fields": [{"name": "run", "type": "string"}]}
    assert read_recording(mini.write(tmp_path)).notes == ()

"""Every rule across rows, tables and files, broken once."""

from collections.abc import Callable
from pathlib import Path

import pytest
from recording.mini import UNUSED, Mini, write_files

from bayesfric.errors import Fault, InputError
from bayesfric.recording import read_recording

TRIALS, EVENTS, PACKAGE = "gravity_trials.csv", "gravity_events.csv", "datapackage.json"
Place = tuple[str, int | None, str | None, str | None]


def faults_of(folder: Path) -> tuple[Fault, ...]:
    with pytest.raises(InputError) as caught:
        read_recording(folder)
    return caught.value.faults


def places(faults: tuple[Fault, ...]) -> list[Place]:
    return [(fault.file, fault.row, fault.column, fault.value) for fault in faults]


def cell(file: str, row: int, column: str, value: str) -> Callable[[Mini], Mini]:
    return lambda mini: mini.set(file, row, column, value)


def without_rows(file: str, *rows: int) -> Callable[[Mini], Mini]:
    def spoil(mini: Mini) -> Mini:
        kept = [cells for line, cells in enumerate(mini.rows[file], start=1) if line not in rows]
        mini.rows[file] = kept
        return mini

    return spoil


def without_rig(key: str) -> Callable[[Mini], Mini]:
    def spoil(mini: Mini) -> Mini:
        del mini.package["rig"][key]
        return mini

    return spoil


RULES: list[tuple[str, Callable[[Mini], Mini], list[Place], str]] = [
    # one board
    (
        "m1 = m2",
        cell(TRIALS, 2, "mass_drive_kg", "1.30"),
        [(TRIALS, 2, "mass_drive_kg", "1.30")],
        "more than mass_load_kg",
    ),
    (
        "moved and did not",
        cell(TRIALS, 2, "did_not_move", "true"),
        [(TRIALS, 2, "did_not_move", "true")],
        "the trial has events or an acceleration",
    ),
    (
        "fewer angles than pulleys",
        cell(TRIALS, 4, "wrap_angles_deg", "110 110 110 110"),
        [(TRIALS, 4, "wrap_angles_deg", "110 110 110 110")],
        "as many angles as pulleys, 5",
    ),
    (
        "an angle in words",
        cell(TRIALS, 4, "wrap_angles_deg", "110 110 110 110 wide"),
        [(TRIALS, 4, "wrap_angles_deg", "110 110 110 110 wide")],
        "numbers from 0 to 180",
    ),
    (
        "angles of another mean",
        cell(TRIALS, 4, "wrap_angles_deg", "110 110 110 110 120"),
        [(TRIALS, 4, "wrap_angles_deg", "110 110 110 110 120")],
        "within 0.5° of wrap_angle_deg, 110",
    ),
    (
        "m1 < m2",
        cell(TRIALS, 4, "mass_load_kg", "0.95"),
        [(TRIALS, 4, "mass_drive_kg", "0.90")],
        "more than mass_load_kg",
    ),
    (
        "setup with two angles",
        cell(TRIALS, 3, "wrap_angle_deg", "86"),
        [(TRIALS, 3, "setup", "a")],
        "for all rows of a setup",
    ),
    (
        "setup with two sizes",
        cell(TRIALS, 3, "pulley_size", "large"),
        [(TRIALS, 3, "setup", "a")],
        "for all rows of a setup",
    ),
    (
        "motor setup with two n",
        cell("motor_runs.csv", 3, "n_pulleys", "8"),
        [("motor_runs.csv", 3, "setup", "x")],
        "for all rows of a setup",
    ),
    # ids
    ("trial twice", cell(TRIALS, 4, "trial", "g1"), [(TRIALS, 4, "trial", "g1")], "no other row"),
    ("order twice", cell(TRIALS, 4, "order", "1"), [(TRIALS, 4, "order", "1")], "no other row"),
    (
        "motor run twice",
        cell("motor_runs.csv", 3, "run", "m1"),
        [("motor_runs.csv", 3, "run", "m1")],
        "no other row",
    ),
    (
        "steady run twice",
        cell("steady_friction.csv", 3, "run", "s1"),
        [("steady_friction.csv", 3, "run", "s1")],
        "no other row",
    ),
    # event trains
    (
        "time backwards",
        cell(EVENTS, 4, "time_s", "0.140000"),
        [(EVENTS, 4, "time_s", "0.140000")],
        "more than the time_s before",
    ),
    (
        "time repeated",
        cell(EVENTS, 4, "time_s", "0.150000"),
        [(EVENTS, 4, "time_s", "0.150000")],
        "more than the time_s before",
    ),
    (
        "displacement repeated",
        cell(EVENTS, 6, "displacement_m", "0.0294"),
        [(EVENTS, 6, "displacement_m", "0.0294")],
        "more than the displacement before",
    ),
    (
        "displacement backwards",
        cell(EVENTS, 6, "displacement_m", "0.0098"),
        [(EVENTS, 6, "displacement_m", "0.0098")],
        "more than the displacement before",
    ),
    (
        "displacement off the grid",
        cell(EVENTS, 4, "displacement_m", "0.0190"),
        [(EVENTS, 4, "displacement_m", "0.0190")],
        "a multiple of rig.hall_spacing_m",
    ),
    (
        "displacement off by little",
        cell(EVENTS, 4, "displacement_m", "0.019602"),
        [(EVENTS, 4, "displacement_m", "0.019602")],
        "a multiple of rig.hall_spacing_m",
    ),
    (
        "first displacement",
        cell(EVENTS, 2, "displacement_m", "-0.0098"),
        [(EVENTS, 2, "displacement_m", "-0.0098")],
        "0 at the first event",
    ),
    (
        "four events",
        without_rows(EVENTS, 6),
        [(EVENTS, 2, "trial", "g1")],
        "at least 5 events of trial 'g1' and sensor 'drive', there are 4",
    ),
    (
        "one event",
        without_rows(EVENTS, 13, 14, 15, 16),
        [(EVENTS, 12, "trial", "g2")],
        "sensor 'load', there are 1",
    ),
    # two tables
    (
        "unmeasured trial",
        without_rows(EVENTS, 12, 13, 14, 15, 16),
        [(TRIALS, 3, "trial", "g2")],
        "or its acceleration_m_s2",
    ),
    (
        "no acceleration",
        cell(TRIALS, 4, "acceleration_m_s2", ""),
        [(TRIALS, 4, "trial", "g3")],
        "or its acceleration_m_s2",
    ),
    (
        "unknown trial",
        without_rows(TRIALS, 3),
        [(EVENTS, 12, "trial", "g2")],  # and 4 like it
        "a trial of gravity_trials.csv",
    ),
    (
        "unknown run",
        cell("axis_samples.csv", 3, "run", "r9"),
        [("axis_samples.csv", 3, "run", "r9")],
        "a run of axis_runs.csv",
    ),
    (
        "run without samples",
        without_rows("axis_samples.csv", 5, 6),
        [("axis_runs.csv", 3, "run", "r2")],
        "samples of this run",
    ),
    (
        "samples backwards",
        cell("axis_samples.csv", 4, "time_s", "0.005"),
        [("axis_samples.csv", 4, "time_s", "0.005")],
        "more than the time_s before",
    ),
    # tables that need one another
    (
        "events alone",
        lambda mini: mini.without(TRIALS),
        [(TRIALS, None, None, None)],
        "because of gravity_events.csv",
    ),
    (
        "trials alone",
        lambda mini: mini.without(EVENTS),
        [(TRIALS, 2, "trial", "g1"), (TRIALS, 3, "trial", "g2")],
        "events of this trial",
    ),
    (
        "runs alone",
        lambda mini: mini.without("motor_idle.csv"),
        [("motor_idle.csv", None, None, None)],
        "because of motor_runs.csv",
    ),
    (
        "idle alone",
        lambda mini: mini.without("motor_runs.csv"),
        [("motor_runs.csv", None, None, None)],
        "because of motor_idle.csv",
    ),
    (
        "axis runs alone",
        lambda mini: mini.without("axis_samples.csv"),
        [("axis_samples.csv", None, None, None)],
        "because of axis_runs.csv",
    ),
    (
        "samples alone",
        lambda mini: mini.without("axis_runs.csv"),
        [("axis_runs.csv", None, None, None)],
        "because of axis_samples.csv",
    ),
    (
        "no table",
        lambda mini: mini.keep(),
        [(PACKAGE, None, "resources", None)],
        "at least one of gravity_trials.csv",
    ),
    # constants of the rig that a table needs
    *(
        (f"no {key}", without_rig(key), [(PACKAGE, None, f"rig.{key}", None)], f"because of {file}")
        for file, keys in {
            EVENTS: ("hall_spacing_m", "magnets_per_revolution", "timer_resolution_s"),
            "motor_runs.csv": ("motor_torque_constant_n_m_per_a", "capstan_radius_m"),
        }.items()
        for key in keys
    ),
]


@pytest.mark.parametrize(
    ("spoil", "expected_places", "rule"),
    [case[1:] for case in RULES],
    ids=[case[0] for case in RULES],
)
def test_broken_rule_gives_exactly_its_faults(
    tmp_path: Path, spoil: Callable[[Mini], Mini], expected_places: list[Place], rule: str
) -> None:
    mini = Mini().kind(expected_places[0][0])
    faults = faults_of(spoil(mini).write(tmp_path))
    assert places(faults) == expected_places
    assert all(rule in fault.expected for fault in faults)


def test_numbers_at_the_edge_of_the_floats_are_compared_quietly(tmp_path: Path) -> None:
    """1e308 m in steps of 1e-300 m overflows on the way to its fault."""
    mini = Mini().set(EVENTS, 4, "displacement_m", "1e308")
    mini.package["rig"]["hall_spacing_m"] = 1e-300
    faults = faults_of(mini.write(tmp_path))
    assert (EVENTS, 4, "displacement_m", "1e308") in places(faults)


@pytest.mark.parametrize(
    ("printed", "off"),
    [
        (["0.00", "0.01", "0.02", "0.03", "0.25"], "0.25"),
        (["0e-2", "0.98e-2", "1.90e-2", "2.94e-2", "3.92e-2"], "1.90e-2"),
    ],
    ids=["digits too few to tell which multiple", "digits behind an exponent"],
)
def test_rounding_excuses_no_more_than_it_must(
    tmp_path: Path, printed: list[str], off: str
) -> None:
    mini = Mini()
    for block in (2, 7, 12):
        for i, text in enumerate(printed):
            mini.set(EVENTS, block + i, "displacement_m", text)
    faults = faults_of(mini.write(tmp_path))
    line = 2 + printed.index(off)
    assert places(faults) == [(EVENTS, line + k, "displacement_m", off) for k in (0, 5, 10)]


def test_unspoilt_recording_has_no_fault(tmp_path: Path) -> None:
    recording = read_recording(Mini().write(tmp_path))
    assert recording.notes == (UNUSED,)


def test_gravity_may_be_none_for_a_joint_and_not_for_masses_on_a_cable(tmp_path: Path) -> None:
    mini = Mini()
    mini.package["rig"]["gravity_m_s2"] = 0
    faults = [
        fault for fault in faults_of(mini.write(tmp_path)) if fault.column == "rig.gravity_m_s2"
    ]
    assert [fault.expected for fault in faults] == [
        "a number above 0, because of gravity_trials.csv",
        "a number above 0, because of motor_runs.csv",
    ]
    mini.package["resources"] = [
        table for table in mini.package["resources"] if table["path"].startswith("axis")
    ]
    assert read_recording(mini.write(tmp_path / "joint")).rig.gravity_m_s2 == 0


@pytest.mark.parametrize("file", list(Mini().rows))
def test_all_faults_are_reported_together(tmp_path: Path, file: str) -> None:
    """A fault in every table, in the JSON and across tables: none hides another."""
    mini = Mini()
    mini.package["created"] = "yesterday"
    mini.package["rig"]["gravity_m_s2"] = -1
    mini.set(TRIALS, 2, "mass_drive_kg", "x").set(TRIALS, 3, "mass_load_kg", "3")
    mini.set(EVENTS, 8, "time_s", "-1").set(EVENTS, 9, "sensor", "middle")
    mini.set("motor_runs.csv", 2, "velocity_m_s", "0").drop("motor_idle.csv", "current_a")
    mini.set("steady_friction.csv", 3, "friction_sd_n", "0")
    mini.set("axis_runs.csv", 2, "order", "0").set("axis_samples.csv", 2, "run", "r7")
    faulty = places(faults_of(mini.write(tmp_path)))
    expected = [
        (PACKAGE, None, "created", "yesterday"),
        (PACKAGE, None, "rig.gravity_m_s2", "-1"),
        (TRIALS, 2, "mass_drive_kg", "x"),
        (TRIALS, 3, "mass_drive_kg", "2.10"),
        (EVENTS, 8, "time_s", "-1"),
        (EVENTS, 9, "sensor", "middle"),
        ("motor_runs.csv", 2, "velocity_m_s", "0"),
        ("motor_idle.csv", 1, "current_a", None),
        ("steady_friction.csv", 3, "friction_sd_n", "0"),
        ("axis_runs.csv", 2, "order", "0"),
        ("axis_samples.csv", 2, "run", "r7"),
    ]
    assert faulty == expected
    # A table that cannot be parsed at all takes nothing else with it, and the tables
    # that refer to it are not blamed for it.
    folder = write_files(tmp_path, {file: b"\xff"})
    assert places(faults_of(folder)) == sorted(
        [place for place in expected if place[0] != file and not refers(place, file)]
        + [(file, 1, None, "byte 0xff")],
        key=lambda place: [PACKAGE, *Mini().rows].index(place[0]),
    )


def refers(place: Place, file: str) -> bool:
    return file == "axis_runs.csv" and place[3] == "r7"

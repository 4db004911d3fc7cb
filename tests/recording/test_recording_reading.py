"""What a good recording becomes: types, defaults, order, notes, fingerprint."""

import hashlib
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from benchmark.kernels import timed
from pytest_benchmark.fixture import BenchmarkFixture
from recording.mini import UNUSED, Mini

from bayesfric.diagnosis.residuals import AXES
from bayesfric.recording import Recording, describe_recording, read_recording, tables_sha256
from bayesfric.recording.axis_notes import notes_on_axis
from bayesfric.recording.columns import TAKEN
from bayesfric.recording.tables import Axis, RigConstants

TRIALS, EVENTS = "gravity_trials.csv", "gravity_events.csv"


def read(mini: Mini, tmp_path: Path) -> Recording:
    return read_recording(mini.write(tmp_path))


def test_types(tmp_path: Path) -> None:
    recording = read(Mini(), tmp_path)
    assert recording.gravity
    assert recording.motor
    assert recording.axis
    assert recording.steady is not None
    frames = [
        recording.gravity.trials,
        recording.gravity.events,
        recording.motor.runs,
        recording.motor.idle,
        recording.steady,
        recording.axis.runs,
        recording.axis.samples,
    ]
    text = {"trial", "run", "setup", "sensor", "pulley_size", "role", "drive_end"}
    text |= {"did_not_move", "joint"}
    for frame in frames:
        assert list(frame.index) == list(range(len(frame)))
        for name in frame:
            expected = "int64" if name in ("n_pulleys", "order") else "float64"
            assert str(frame[name].dtype) == ("str" if name in text else expected)
    trials = recording.gravity.trials
    assert trials["role"].isna().tolist() == [False, False, True]
    assert trials["acceleration_m_s2"].isna().tolist() == [True, True, False]
    assert recording.axis.runs["payload_kg"].tolist() == [0.0, 1.5]


def test_a_simulated_position_without_its_mass_is_said_not_to_be_used():
    def notes(mass=None, **columns):
        samples = pd.DataFrame({"run": ["a"], "position_m": [0.0], **columns})
        rig = RigConstants(moving_mass_kg=mass)
        return " ".join(notes_on_axis(Axis(pd.DataFrame(), samples), rig))

    assert "not used: it takes rig.moving_mass_kg" in notes(sim_position_m=[0.0])
    assert notes() == notes(2.0, sim_position_m=[0.0]) == notes(sim_force_n=[0.0]) == ""


def test_columns_come_in_the_order_of_the_format(tmp_path: Path) -> None:
    mini = Mini()
    mini.rows[TRIALS] = [cells[::-1] for cells in mini.rows[TRIALS]]
    (tmp_path / "reversed").mkdir()
    gravity = read(mini, tmp_path / "reversed").gravity
    other = read(Mini(), tmp_path / "straight").gravity
    assert gravity is not None
    assert other is not None
    empty = "wrap_angles_deg"  # from top to bottom, which counts as left out
    expected = [name for name in Mini().rows[TRIALS][0] if name != empty]
    assert list(gravity.trials.columns) == list(other.trials.columns) == expected


@pytest.mark.parametrize("file", [TRIALS, "motor_runs.csv"])
def test_setup_is_filled_in(tmp_path: Path, file: str) -> None:
    mini = Mini().drop(file, "setup").set(file, 3, "wrap_angle_deg", "85.5")
    recording = read(mini, tmp_path)
    assert recording.gravity
    assert recording.motor
    frame = recording.gravity.trials if file == TRIALS else recording.motor.runs
    expected = ["medium-9-85", "medium-9-85.5", "small-5-110"]
    assert frame["setup"].tolist() == expected[: len(frame)]
    assert str(frame["setup"].dtype) == "str"
    assert list(frame.columns)[:3] in (["trial", "order", "setup"], ["run", "order", "setup"])


def test_setup_and_order_of_kinds_without_assembly_stay_absent(tmp_path: Path) -> None:
    mini = Mini().drop("axis_runs.csv", "setup").drop("steady_friction.csv", "setup", "order")
    recording = read(mini, tmp_path)
    assert recording.axis
    assert recording.steady is not None
    assert "setup" not in recording.axis.runs
    assert not {"setup", "order"} & set(recording.steady.columns)


def test_gravity_default(tmp_path: Path) -> None:
    mini = Mini()
    del mini.package["rig"]["gravity_m_s2"]
    assert read(mini, tmp_path).rig.gravity_m_s2 == 9.80665


def test_events_are_sorted_by_trial_and_sensor(tmp_path: Path) -> None:
    """Trains may be interleaved in the file; trials keep the file's order."""
    mini = Mini()
    header, *rows = mini.rows[EVENTS]
    mini.rows[EVENTS] = [header, *sorted(rows, key=lambda row: float(row[3]))]
    mini.rows[TRIALS][1:3] = mini.rows[TRIALS][2:0:-1]
    gravity = read(mini, tmp_path).gravity
    assert gravity is not None
    assert gravity.trials["trial"].tolist() == ["g2", "g1", "g3"]
    keys = list(zip(gravity.events["trial"], gravity.events["sensor"], strict=True))
    assert keys == [("g2", "load")] * 5 + [("g1", "drive")] * 5 + [("g1", "load")] * 5
    assert gravity.events.groupby(["trial", "sensor"])["time_s"].is_monotonic_increasing.all()


@pytest.mark.parametrize(
    "printed",
    [
        ["0", "0.0098", "0.0196", "0.0294", "0.0392"],
        ["0", "0.0098001", "0.0196", "0.0294", "0.0392"],
        ["0.000", "0.010", "0.020", "0.029", "0.039"],
        ["0e0", "9.8e-3", "19.6e-3", "2.94e-2", "3.92E-2"],
        ["-0.0", "0.009800000000000001", "0.0196", "0.029400000000000003", "0.0392"],
    ],
    ids=["short", "within 1 µm", "three digits", "exponents", "seventeen digits"],
)
def test_displacements_become_exact_multiples(tmp_path: Path, printed: list[str]) -> None:
    mini = Mini().keep(TRIALS, EVENTS)
    for block in (2, 7, 12):
        for i, text in enumerate(printed):
            mini.set(EVENTS, block + i, "displacement_m", text)
    gravity = read(mini, tmp_path).gravity
    assert gravity is not None
    expected = np.tile(np.arange(5) * 0.0098, 3)
    np.testing.assert_array_equal(gravity.events["displacement_m"], expected)
    assert not np.signbit(gravity.events["displacement_m"]).any()


def test_missed_and_doubled_events_are_data(tmp_path: Path) -> None:
    mini = Mini().set(EVENTS, 5, "displacement_m", "0.0392")  # a gap of two spacings
    mini.set(EVENTS, 6, "displacement_m", "0.0490").set(EVENTS, 14, "time_s", "0.350004")
    gravity = read(mini, tmp_path).gravity
    assert gravity is not None
    travel = gravity.events["displacement_m"].to_numpy()[:5]
    np.testing.assert_allclose(travel / 0.0098, [0, 1, 2, 4, 5])


def test_accelerations_need_no_events(tmp_path: Path) -> None:
    mini = Mini().keep(TRIALS)
    mini.rows[TRIALS] = [mini.rows[TRIALS][0], mini.rows[TRIALS][3]]
    for key in ("hall_spacing_m", "magnets_per_revolution", "timer_resolution_s"):
        del mini.package["rig"][key]
    gravity = read(mini, tmp_path).gravity
    assert gravity is not None
    assert gravity.events.empty
    assert list(gravity.events.columns) == ["trial", "sensor", "displacement_m", "time_s"]


def test_unknown_columns_are_kept_out_and_mentioned(tmp_path: Path) -> None:
    mini = Mini().add(TRIALS, "weather", ["fine"] * 3).add(TRIALS, "room_c", ["21"] * 3)
    mini.add("axis_runs.csv", "operator", ["Ann", "Bob"])
    mini.add("axis_runs.csv", "lever_m", ["0.1", ""]).add("axis_runs.csv", "tilt_deg", ["1", "2"])
    recording = read(mini, tmp_path)
    assert recording.gravity
    assert recording.axis
    assert not {"weather", "room_c"} & set(recording.gravity.trials.columns)
    assert list(recording.axis.runs.columns)[-2:] == ["payload_kg", "tilt_deg"]
    assert recording.notes == (
        "gravity_trials.csv: unknown column 'weather' kept out",
        "gravity_trials.csv: unknown column 'room_c' kept out",
        "axis_runs.csv: unknown column 'operator' kept out (not a number in every row)",
        "axis_runs.csv: unknown column 'lever_m' kept out (not a number in every row)",
        UNUSED,
    )


def test_a_covariate_takes_no_name_that_results_have(tmp_path: Path) -> None:
    """A column `velocity` would stand in the place of the speed, and `trial` in that of the id."""
    mini = Mini().add("steady_friction.csv", "velocity", ["1", "2"])
    mini.add("steady_friction.csv", "trial", ["1", "2"]).add("axis_runs.csv", "rig", ["1", "2"])
    recording = read(mini, tmp_path)
    assert recording.notes[:3] == tuple(
        f"{file}: column {name!r} kept out (results have this name: rename it)"
        for file, name in (
            ("steady_friction.csv", "velocity"),
            ("steady_friction.csv", "trial"),
            ("axis_runs.csv", "rig"),
        )
    )
    assert set(AXES) - {"order", "setup"} <= TAKEN


def test_conditions_outside_table_2_are_notes(tmp_path: Path) -> None:
    mini = Mini()
    mini.set(TRIALS, 2, "setup", "c").set(TRIALS, 2, "wrap_angle_deg", "151")
    mini.set(TRIALS, 3, "n_pulleys", "20")
    mini.set(TRIALS, 4, "mass_drive_kg", "6.2").set(TRIALS, 4, "wrap_angle_deg", "14")
    for line, moment in enumerate(("0.3", "0.306", "0.312", "0.318", "0.324"), start=12):
        mini.set(EVENTS, line, "time_s", moment)
    mini.set("motor_runs.csv", 2, "hanging_mass_kg", "3.4").set(
        "motor_runs.csv", 2, "current_a", "8.9"
    )
    mini.set("motor_runs.csv", 3, "velocity_m_s", "-1.31")
    mini.set("steady_friction.csv", 2, "tension_n", "33.1")
    table = "outside the paper's Table II"
    assert read(mini, tmp_path).notes == (
        UNUSED,
        f"{table}: |v| at most 1.3 m/s (trial g2); tension at most 33 N (trial g3); at most 19 "
        "pulleys (trial g2); individual wrap angle 15 to 180 deg (trial g3); average wrap angle "
        "45 to 150 deg (trial g1, g3)",
        f"{table}: |v| at most 1.3 m/s (run m2); tension at most 33 N (run m1)",
        f"{table}: tension at most 33 N (run s1)",
    )


def test_many_runs_outside_table_2_are_one_note(tmp_path: Path) -> None:
    mini = Mini().keep("steady_friction.csv")
    header, row, _ = mini.rows["steady_friction.csv"]
    more = [[f"r{k}", *row[1:]] for k in range(1008)]
    mini.rows["steady_friction.csv"] = [header, *more]
    mini.drop("steady_friction.csv", "order")
    for line in range(2, 1010):
        mini.set("steady_friction.csv", line, "tension_n", "34")
    assert read(mini, tmp_path).notes == (
        "outside the paper's Table II: tension at most 33 N (run r0, r1, r2, r3, r4 and "
        "1,003 more)",
    )


def test_rotary_bench_is_not_held_against_table_2(tmp_path: Path) -> None:
    mini = Mini().set("steady_friction.csv", 2, "tension_n", "330")
    mini.package["rig"]["rotary"] = True
    assert read(mini, tmp_path).notes == (UNUSED,)


def test_sha256_is_over_the_tables_sorted_by_name(tmp_path: Path) -> None:
    mini = Mini()
    recording = read(mini, tmp_path)
    digest = hashlib.sha256()
    for name in sorted(mini.rows):
        digest.update(name.encode() + b"\0" + mini.contents()[name] + b"\0")
    assert recording.sha256 == digest.hexdigest()
    tables = {name: mini.contents()[name] for name in mini.rows}
    assert tables_sha256(dict(reversed(tables.items()))) == recording.sha256
    mini.package["title"] = "Another title"
    assert read(mini, tmp_path).sha256 == recording.sha256
    mini.set("motor_idle.csv", 2, "current_a", "0.0611")
    assert read(mini, tmp_path).sha256 != recording.sha256


def test_description(tmp_path: Path) -> None:
    recording = read(Mini(), tmp_path)
    assert describe_recording(recording) == (
        ("name", "mini"),
        ("title", "A small recording"),
        ("created", "2026-11-01T00:00:00Z"),
        ("gravity", "9.81 m/s²"),
        ("gravity board", "3 trials, 15 events, 1 with an acceleration only"),
        (
            "  medium",
            "2 trials on 1 setup, n = 9, wrap 85 deg, tension 14.2 to 19.1 N, "
            "sensors drive and load",
        ),
        ("  small", "1 trial on 1 setup, n = 5, wrap 110 deg, tension 7.36 N"),
        ("motor board", "2 runs, 2 idle points"),
        (
            "  medium",
            "2 runs on 1 setup, n = 9, wrap 85 deg, tension 14.7 N, v -0.5 to 0.5 m/s",
        ),
        ("steady friction", "2 points, -0.94 to 0.74 N, tension 15.5 to 20.5 N, v -0.3 to 0.3 m/s"),
        ("single axis", "2 runs, 5 samples, with payload_kg, of 1 joint"),
        ("  log", "up to 0.02 s and 0.003 m a run, a sample every 0.01 s, force 1.1 to 2.2 N"),
        ("sha256", recording.sha256),
    )


def test_a_log_of_one_sample_has_no_pace():
    samples = pd.DataFrame({"run": ["a"], "time_s": [0.0], "position_m": [0.1], "force_n": [2.0]})
    axis = Axis(pd.DataFrame({"run": ["a"]}), samples)
    recording = Recording(name="log", title="Short", rig=RigConstants(), axis=axis)
    lines = dict(describe_recording(recording))
    assert lines["  log"] == "up to 0 s and 0 m a run, force 2 N"


@pytest.mark.bench
def test_72000_events_are_read_in_under_a_second_and_a_half(
    tmp_path: Path, benchmark: BenchmarkFixture
) -> None:
    mini = Mini().keep(TRIALS, EVENTS)
    header = mini.rows[TRIALS][0]
    trial = dict(zip(header, mini.rows[TRIALS][1], strict=True))
    ids = [f"t{i:03d}" for i in range(600)]
    mini.rows[TRIALS] = [
        header,
        *([*(trial | {"trial": name, "order": str(i + 1)}).values()] for i, name in enumerate(ids)),
    ]
    mini.rows[EVENTS] = [
        mini.rows[EVENTS][0],
        *(
            [name, sensor, f"{k * 0.0098:.4f}", f"{0.1 + k * 0.02:.6f}"]
            for name in ids
            for sensor in ("drive", "load")
            for k in range(60)
        ),
    ]
    folder = mini.write(tmp_path)
    name = "reading 72,000 events"
    recording = timed(benchmark, name, read_recording, folder, within_s=1.5)
    assert recording.gravity is not None
    assert len(recording.gravity.events) == 72_000

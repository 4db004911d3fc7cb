"""One motion as every kind of log: the same recording, to the byte, and it is the motion."""

import re

import numpy as np
import pytest
from logs.written import ENDS, JOINTS, MAPPINGS, RATE_HZ, WRITERS, mapping_of, motion, write

from bayesfric.errors import InputError
from bayesfric.logs import import_log
from bayesfric.logs.readers import read_log
from bayesfric.recording import read_recording, write_recording


def mapped(folder, text):
    (folder / "map.toml").write_text(text, encoding="utf-8")
    return folder / "map.toml"


@pytest.fixture(scope="module")
def recordings(tmp_path_factory):
    """The recording of each kind, written."""
    folders = {}
    for end in ENDS:
        folder = tmp_path_factory.mktemp(end.replace(".", "-"))
        made = import_log(write(folder, end), "elbow", mapping=mapped(folder, MAPPINGS[end]))
        write_recording(made.recording, folder / "made")
        folders[end] = folder / "made"
    return folders


@pytest.mark.parametrize("end", ENDS)
def test_it_is_the_motion(recordings, end):
    time, position, torque = motion()
    recording = read_recording(recordings[end])
    samples = recording.axis.samples
    assert np.array_equal(samples["time_s"], time.round(9))
    assert np.array_equal(samples["position_m"], position[:, 1].round(9))
    assert np.array_equal(samples["force_n"], torque[:, 1].round(9))
    assert recording.rig.force_is == "motor"
    assert recording.rig.rotary
    assert not any("longer side" in note for note in recording.notes)


def test_a_matrix_that_is_wider_than_long_is_turned_and_it_is_said(tmp_path):
    time, position, torque = motion()
    np.savez(tmp_path / "log.npz", t=time, q=position.T, tau=torque)
    made = import_log(tmp_path / "log.npz", mapping=mapped(tmp_path, MAPPINGS["npz"]))
    assert "q is 2 × 300: its longer side is taken as time." in made.notes
    assert np.array_equal(made.recording.axis.samples["position_m"], position[:, 1].round(9))


@pytest.mark.parametrize("end", ENDS[1:])
def test_the_bytes_of_its_numbers_are_those_of_a_csv(recordings, end):
    for table in ("axis_samples.csv", "axis_runs.csv"):
        assert (recordings[end] / table).read_bytes() == (recordings["csv"] / table).read_bytes()


@pytest.mark.parametrize("end", ENDS)
def test_numbers_of_32_bits_are_the_decimals_that_they_stand_for(tmp_path, end):
    """At 125 Hz no stamp is exact in 32 bits, and no thousandth of a radian is."""
    rows = np.arange(200)
    both = np.stack([np.sin(rows / 30), np.cos(rows / 40)], axis=1).round(3)
    path = WRITERS[end](tmp_path, rows / 125, both, both[:, ::-1].copy())
    text = MAPPINGS[end].replace(f"rate_hz = {RATE_HZ}", "rate_hz = 125")
    made = import_log(path, "elbow", mapping=mapped(tmp_path, text)).recording.axis.samples
    assert np.array_equal(made["time_s"], (rows / 125).round(9))
    assert np.array_equal(made["position_m"], both[:, 1])
    assert np.array_equal(made["force_n"], both[:, 0])


@pytest.mark.parametrize("end", ["json", "parquet", "bag"])
def test_all_joints_are_in_one_table(tmp_path, end):
    time, position, torque = motion()
    made = import_log(write(tmp_path, end), "all", mapping=mapped(tmp_path, MAPPINGS[end]))
    write_recording(made.recording, tmp_path / "made")
    samples = read_recording(tmp_path / "made").axis.samples
    for place, joint in enumerate(JOINTS):
        own = samples[samples["joint"] == joint]
        assert np.array_equal(own["time_s"], time.round(9))
        assert np.array_equal(own["position_m"], position[:, place].round(9))
        assert np.array_equal(own["force_n"], torque[:, place].round(9))


@pytest.mark.parametrize("base", [True, False])
def test_columns_without_names_are_said_joint_by_joint(tmp_path, base):
    """A base column alone is of one joint; each joint's own makes them all, with no base."""
    _, position, torque = motion()
    text = "".join(
        f"[joints.{joint}]\nposition = {{ column = {place} }}\nforce = {{ column = {place + 2} }}\n"
        for place, joint in enumerate(JOINTS, start=1)
    )
    whole = MAPPINGS["csv"].replace("[[runs]]", f"{text}[[runs]]")
    shared, own, runs = whole.partition("[joints.")
    if not base:
        shared = re.sub(r"column = \d\n", "", shared)
    mapping, log = mapped(tmp_path, shared + own + runs), write(tmp_path, "csv")
    samples = import_log(log, "all", mapping=mapping).recording.axis.samples
    elbow = import_log(log, "elbow", mapping=mapping).recording.axis.samples
    assert np.array_equal(elbow["position_m"], position[:, JOINTS.index("elbow")].round(9))
    with pytest.raises(InputError, match="--joint: expected all, or one of the joints"):
        import_log(log, mapping=mapping)
    for place, joint in enumerate(JOINTS):
        own = samples[samples["joint"] == joint]
        assert np.array_equal(own["position_m"], position[:, place].round(9))
        assert np.array_equal(own["force_n"], torque[:, place].round(9))


def test_a_joint_may_have_a_sign_and_a_gear_of_its_own(tmp_path):
    _, position, torque = motion()
    more = "[joints.elbow]\nforce = { sign = -1, gear_ratio = 2 }\nposition = { sign = -1 }\n"
    text = MAPPINGS["json"].replace("[[runs]]", f"{more}[[runs]]")
    made = import_log(write(tmp_path, "json"), "all", mapping=mapped(tmp_path, text))
    samples = made.recording.axis.samples
    elbow, shoulder = (samples[samples["joint"] == joint] for joint in ("elbow", "shoulder"))
    assert np.array_equal(elbow["force_n"], -2 * torque[:, 1])
    assert np.array_equal(elbow["position_m"], -position[:, 1].round(9))
    assert np.array_equal(shoulder["force_n"], torque[:, 0])


def of_all(folder, more="", top=""):
    """All joints of the JSON log, with keys for the elbow, or at the top."""
    text = top + MAPPINGS["json"].replace("[[runs]]", f"{more}[[runs]]")
    return import_log(write(folder, "json"), "all", mapping=mapped(folder, text)).recording


def test_what_is_declared_of_an_encoder_is_of_all_joints(tmp_path):
    assert of_all(tmp_path, top="encoder_resolution = 1e-4\n").rig.encoder_resolution == 1e-4


@pytest.mark.parametrize(
    ("more", "top", "said"),
    [
        (
            "",
            "moving_mass = 2.5\n",
            "moving_mass: found '2.5', expected the mass of one joint, and 2",
        ),
        (
            '[joints.elbow.position]\nunit = "mm"\n',
            "",
            "joints.elbow.position.unit: found 'mm', expected a unit as that of the other joints",
        ),
        (
            '[joints.elbow.force]\nforce_is = "link"\n',
            "",
            "force.force_is: found 'shoulder: motor, elbow: link', expected one force_is for all",
        ),
    ],
)
def test_what_cannot_be_of_all_joints_is_refused(tmp_path, more, top, said):
    with pytest.raises(InputError, match=said):
        of_all(tmp_path, more, top)


def test_a_joint_alone_has_its_own_kind_of_force(tmp_path):
    text = MAPPINGS["json"].replace("[[runs]]", '[joints.elbow]\nforce.force_is = "link"\n[[runs]]')
    path = mapped(tmp_path, f"moving_mass = 2.5\n{text}")
    rig = import_log(write(tmp_path, "json"), "elbow", mapping=path).recording.rig
    assert rig.force_is == "link"
    assert rig.moving_mass_kg == 2.5
    assert (
        import_log(tmp_path / "log.json", "shoulder", mapping=path).recording.rig.force_is
        == "motor"
    )


def test_several_files_are_runs(tmp_path):
    _, position, _ = motion()
    files = []
    for name, rows in (("slow", slice(0, 100)), ("fast", slice(100, 300))):
        lines = "".join(f"{q!r} 0.5\n" for q in position[rows, 0].tolist())
        files.append(tmp_path / f"{name}.txt")
        files[-1].write_text(lines, encoding="utf-8")
    text = (
        MAPPINGS["csv"]
        .replace("column = 2", "column = 1")
        .replace("column = 4", "column = 2")
        .replace("[csv]", '[csv]\nseparator = "space"')
        .partition("[[runs]]")[0]
    )
    made = import_log(files, mapping=mapped(tmp_path, text))
    assert list(made.recording.axis.runs["run"]) == ["slow", "fast"]
    samples = made.recording.axis.samples
    fast = samples[samples["run"] == "fast"]
    assert np.array_equal(fast["position_m"], position[100:, 0].round(9))
    assert fast["time_s"].iloc[0] == 0
    runs_text = '[[runs]]\nname = "a"\nfile = "fast.txt"\nrole = "test"\nload_kg = 2.0\n'
    runs_text += '[[runs]]\nname = "b"\nfile = "slow.txt"\nto_s = 1.0\nload_kg = 1.0\n'
    runs = import_log(files, mapping=mapped(tmp_path, text + runs_text)).recording.axis.runs
    assert list(runs["run"]) == ["b", "a"]
    assert list(runs["load_kg"]) == [1.0, 2.0]


def test_a_column_says_where_runs_begin(tmp_path):
    """LeRobot's clock begins again with each episode."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    time, position, torque = motion(100)
    table = pa.table(
        {
            "observation.state": pa.array(np.repeat(position, 2, axis=0).tolist()[:200]),
            "effort": pa.array(np.tile(torque[:, 0], 2)),
            "timestamp": pa.array(np.tile(time, 2), pa.float32()),
            "episode_index": pa.array(np.repeat([3, 4], 100), pa.int64()),
        }
    )
    pq.write_table(table, tmp_path / "log.parquet")
    text = (
        'run = "episode_index"\n[time]\ncolumn = "timestamp"\n[position]\n'
        'column = "observation.state[0]"\nunit = "rad"\n[force]\ncolumn = "effort"\n'
        'unit = "N·m"\nforce_is = "measured"\n'
    )
    made = import_log(tmp_path / "log.parquet", mapping=mapped(tmp_path, text))
    samples = made.recording.axis.samples
    assert list(made.recording.axis.runs["run"]) == ["3", "4"]
    for run in ("3", "4"):
        assert np.array_equal(samples.loc[samples["run"] == run, "time_s"], time.round(9))
    assert np.array_equal(samples.loc[samples["run"] == "4", "force_n"], torque[:, 0])


def test_commands_of_a_trajectory_hold_until_the_next(tmp_path):
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    kinds = {name.rpartition("/")[2]: kind for name, kind in store.types.items()}
    stamp, header = kinds["Time"], kinds["Header"]
    state, trajectory, point = (
        kinds[name] for name in ("JointState", "JointTrajectory", "JointTrajectoryPoint")
    )
    nothing = np.zeros(0)
    with Writer(tmp_path / "bag", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        states = writer.add_connection("/s", state.__msgtype__, typestore=store)
        commands = writer.add_connection("/c", trajectory.__msgtype__, typestore=store)
        for row in range(40):
            now = header(stamp(100 + row // 10, row % 10 * 10**8), "")
            message = state(now, ["a"], np.array([row / 8]), nothing, nothing)
            raw = store.serialize_cdr(message, state.__msgtype__)
            writer.write(states, row * 10**8, raw)
        points = [
            point(np.array([float(k)]), nothing, nothing, nothing, stamp(k, 5 * 10**8))
            for k in range(4)
        ]
        raw = store.serialize_cdr(
            trajectory(header(stamp(99, 0), ""), ["a"], points), trajectory.__msgtype__
        )
        writer.write(commands, 0, raw)
    text = (
        '[time]\ncolumn = "/s.stamp"\nunit = "ns"\n[position]\ncolumn = "/s.position[a]"\n'
        'unit = "rad"\n[command]\ncolumn = "/c.position[a]"\ntime = "/c.stamp"\nunit = "rad"\n'
    )
    made = import_log(tmp_path / "bag", mapping=mapped(tmp_path, text))
    samples = made.recording.axis.samples  # commands at 99.5, 100.5, 101.5, 102.5 s
    time = samples["time_s"].to_numpy()
    assert time[-1] == pytest.approx(2.5)
    assert np.array_equal(samples["command_m"], np.floor(np.round(time + 0.5, 6)))
    assert samples["command_time_s"].to_numpy()[:6] == pytest.approx([-0.5] * 5 + [0.5])
    write_recording(made.recording, tmp_path / "made")
    assert "command_m" in read_recording(tmp_path / "made").axis.samples


def states_at(folder, stamps_s, received_s):
    """A bag of joint states with these stamps, received at other times."""
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    kinds = {name.rpartition("/")[2]: kind for name, kind in store.types.items()}
    with Writer(folder / "bag", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        state = kinds["JointState"]
        link = writer.add_connection("/s", state.__msgtype__, typestore=store)
        for stamp_s, at_s in zip(stamps_s, received_s, strict=True):
            stamp = kinds["Time"](*divmod(round(1e9 * stamp_s), 10**9))
            number = np.array([stamp_s])
            message = state(kinds["Header"](stamp, ""), ["a"], number, number, number)
            raw = store.serialize_cdr(message, state.__msgtype__)
            writer.write(link, round(1e9 * at_s), raw)
    return read_log(folder / "bag", None)


def test_a_simulation_that_begins_at_0_keeps_its_clock(tmp_path):
    time = np.arange(5) / 10
    log = states_at(tmp_path, time, 1000 + 2 * time)
    assert np.array_equal(log.columns["/s.stamp"], np.round(1e9 * time))
    assert log.notes == ()


def test_messages_without_stamps_have_the_times_of_reception(tmp_path):
    log = states_at(tmp_path, np.zeros(5), 1000 + np.arange(5) / 10)
    assert np.array_equal(log.columns["/s.stamp"], 10**12 + 10**8 * np.arange(5))
    assert "no stamps; the times of reception are taken" in log.notes[0]


def test_a_parquet_column_may_have_its_unit_in_brackets(tmp_path):
    import pyarrow as pa
    import pyarrow.parquet as pq

    time, position, torque = motion(50)
    names = ("t", "position [rad]", "torque [N·m]")
    pq.write_table(
        pa.table(dict(zip(names, (time, position[:, 0], torque[:, 0]), strict=True))),
        tmp_path / "log.parquet",
    )
    text = mapping_of('"position [rad]"', '"torque [N·m]"', 'column = "t"')
    samples = import_log(
        tmp_path / "log.parquet", mapping=mapped(tmp_path, text)
    ).recording.axis.samples
    assert np.array_equal(samples["position_m"], position[:, 0].round(9))


UNITS = [
    ("deg", "", 180.0, np.pi),
    ("mrad", "", 5.0, 0.005),
    ("turn", "", 0.5, np.pi),
    ("tick", "counts_per_turn = 4096", 1024, np.pi / 2),
    ("tick", "counts_per_turn = 4096\ngear_ratio = 8", 1024, np.pi / 16),
    ("tick", "factor = 0.001", 7, 0.007),
]
FORCES = [
    ("N·mm", "", 250.0, 0.25),
    ("mN·m", "", 250.0, 0.25),
    ("kgf·cm", "", 10.0, 0.980665),
    ("A", "factor = 0.12\ngear_ratio = 100", 2.0, 24.0),
    ("mA", "factor = 0.12", 500.0, 0.06),
    ("V", "factor = 0.5", 3.0, 1.5),
    ("share", "factor = 4.0\nsign = -1", 0.25, -1.0),
    ("%", "factor = 4.0", 25.0, 1.0),
    ("raw", "factor = 0.01", 100.0, 1.0),
]


@pytest.mark.parametrize(("key", "unit", "more", "value", "truth"), [
    *(("position", *row) for row in UNITS), *(("force", *row) for row in FORCES)
])  # fmt: skip
def test_units_and_their_factors(tmp_path, key, unit, more, value, truth):
    signals = {
        "position": 'column = 1\nunit = "rad"\n',
        "force": 'column = 2\nunit = "N·m"\nforce_is = "motor"\n',
    }
    signals[key] = signals[key].replace("rad", unit).replace("N·m", unit) + more
    text = f"[csv]\nheader = false\n[time]\nrate_hz = {RATE_HZ}\n"
    text += "".join(f"[{name}]\n{lines}\n" for name, lines in signals.items())
    (tmp_path / "log.csv").write_text(f"{value},{value}\n" * 3, encoding="utf-8")
    samples = import_log(
        tmp_path / "log.csv", mapping=mapped(tmp_path, text)
    ).recording.axis.samples
    column = {"position": "position_m", "force": "force_n"}[key]
    assert samples[column].to_numpy() == pytest.approx(truth, abs=1e-9)


HEAD = "t;q [deg];tau\ns;deg;Nm\n"
ROWS = "0,00;90,0;1,5\n0,01;45,0;1,25\n0,02;0,0;1,0\n"


def test_a_csv_with_preamble_units_semicolons_and_commas(tmp_path):
    (tmp_path / "log.csv").write_text(f"Logger 3.1\n\n{HEAD}{ROWS}\n\n", encoding="utf-8-sig")
    text = (
        '[csv]\nseparator = ";"\npreamble = 2\nunit_rows = 1\ndecimal = ","\n'
        '[time]\ncolumn = "t"\n[position]\ncolumn = "q [deg]"\nunit = "deg"\n'
        '[force]\ncolumn = 3\nunit = "N·m"\nforce_is = "link"\n'
    )
    made = import_log(tmp_path / "log.csv", mapping=mapped(tmp_path, text))
    samples = made.recording.axis.samples
    assert samples["position_m"].to_numpy() == pytest.approx([np.pi / 2, np.pi / 4, 0], abs=1e-9)
    assert list(samples["force_n"]) == [1.5, 1.25, 1.0]
    (tmp_path / "log.csv").write_text(f"Logger 3.1\n\n{HEAD}{ROWS}".replace("45", "4x5"), "utf-8")
    with pytest.raises(InputError, match=r"row 6, q \[deg\]: found '4x5,0', expected a number"):
        import_log(tmp_path / "log.csv", mapping=tmp_path / "map.toml")

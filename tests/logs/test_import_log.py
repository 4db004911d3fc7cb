"""Logs to recordings, against numbers worked out by hand and delays that were put in."""

import builtins
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

from bayesfric.cli import app
from bayesfric.errors import InputError
from bayesfric.logs import import_log
from bayesfric.logs.delay import delay_between
from bayesfric.logs.ordering import Series
from bayesfric.recording import read_recording
from bayesfric.resources import data_folder

ELBOW = data_folder() / "logs" / "made-elbow"
RUN = '\n[[runs]]\nname = "a"\nfrom_s = 5\nto_s = '
MAPPING = """
[position]
column = "q"
unit = "rad"
[force]
column = "tau"
unit = "N·m"
force_is = "motor"
"""
BAG = """
time = { column = "/joint_states.stamp", unit = "ns" }
[position]
column = "/joint_states.position[{joint}]"
unit = "rad"
[force]
column = "/joint_commands.effort[{joint}]"
time = "/joint_commands.stamp"
unit = "N·m"
force_is = "commanded"
[measured_force]
column = "/joint_states.effort[{joint}]"
unit = "N·m"
"""


def test_the_bundled_log_is_that_of_the_joint_behind_the_gear(tmp_path):
    """q = 0.2 sin 2πt rad and 0.05 q̈ + 0.4 N·m, of which the log has motor degrees and amperes."""
    call = ["import", str(ELBOW / "log.csv"), "-o", str(tmp_path / "made"), "--joint", "elbow"]
    done = CliRunner().invoke(app, [*call, "--map", str(ELBOW / "mapping.toml")])
    assert done.exit_code == 0, done.output
    back = read_recording(tmp_path / "made")
    assert back.rig.rotary
    assert back.rig.force_is == "commanded"
    assert back.rig.encoder_resolution == 1e-5
    runs, samples = back.axis.runs, back.axis.samples
    assert list(runs["run"]) == ["first", "second"]
    assert list(runs["role"]) == ["calibrate", "test"]
    assert list(runs["payload_kg"]) == [0.0, 0.5]
    time = samples["time_s"].to_numpy()
    assert time == pytest.approx(np.arange(12) * 0.01)
    assert list(samples["run"]) == 6 * ["first"] + 6 * ["second"]
    angle = 0.2 * np.sin(2 * np.pi * time)
    assert samples["position_m"].to_numpy() == pytest.approx(angle, abs=1e-6)
    torque = -0.05 * (2 * np.pi) ** 2 * angle + 0.4
    assert samples["force_n"].to_numpy() == pytest.approx(torque, abs=1e-4)


def swings(time):
    return 2 * np.sin(2 * np.pi * 0.7 * time) + np.sin(2 * np.pi * 2.3 * time + 1)


@pytest.mark.nightly
@pytest.mark.parametrize("late", [0.0073, 0.0, -0.004])
def test_a_delay_is_found_with_an_error_that_holds(late):
    """Sixty noises: the standard error is that of the estimates, and they lie around the truth."""
    rng = np.random.default_rng(1)
    sent, read = np.arange(0, 4, 0.004), np.arange(0.0013, 4, 0.005)
    delays = []
    for _ in range(60):
        value = 0.3 + 0.9 * swings(read - late) + 0.2 * rng.standard_normal(read.size)
        delays.append(delay_between(Series(sent, swings(sent)), Series(read, value)))
    off = np.array([delay.seconds for delay in delays]) - late
    error = np.array([delay.error_s for delay in delays])
    assert abs(off.mean()) < 4 * error.mean() / np.sqrt(60)
    assert np.std(off) == pytest.approx(error.mean(), rel=0.3)
    assert error.mean() < 2e-3


def bag_map(folder):
    (folder / "bag.toml").write_text(BAG, encoding="utf-8")
    return folder / "bag.toml"


def made_bag(folder, storage, late=0.006):
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    state, header = (
        store.types[name] for name in ("sensor_msgs/msg/JointState", "std_msgs/msg/Header")
    )
    stamp = store.types["builtin_interfaces/msg/Time"]
    plugin = StoragePlugin.MCAP if storage == "mcap" else StoragePlugin.SQLITE3
    with Writer(folder, version=9, storage_plugin=plugin) as writer:
        for topic, step, begin in (("/joint_states", 0.005, 0.001), ("/joint_commands", 0.004, 0)):
            link = writer.add_connection(topic, state.__msgtype__, typestore=store)
            for time in 100 + begin + step * np.arange(600):
                whole, part = divmod(round(time * 1e9), 10**9)
                effort = swings(time - late) if topic == "/joint_states" else swings(time)
                message = state(
                    header(stamp(whole, part), ""),
                    ["wrist", "elbow"],
                    np.array([9.0, np.sin(time)]),
                    np.zeros(2),
                    np.array([9.0, effort]),
                )
                raw = store.serialize_cdr(message, state.__msgtype__)
                writer.write(link, round(time * 1e9), raw)
    return folder


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
def test_a_bag_has_the_command_as_sent_and_says_how_late_the_force_is(tmp_path, storage):
    imported = import_log(made_bag(tmp_path / "bag", storage), "elbow", mapping=bag_map(tmp_path))
    samples = imported.recording.axis.samples
    time = samples["time_s"].to_numpy() + 100.001
    assert samples["position_m"].to_numpy() == pytest.approx(np.sin(time), abs=1e-8)
    # As sent, not moved by the delay: 6 ms would be up to 0.1 here.
    assert samples["force_n"].to_numpy() == pytest.approx(swings(time), abs=2e-3)
    assert imported.delay.seconds == pytest.approx(0.006, abs=1e-4)
    assert any("6.00 ± " in note and "left in" in note for note in imported.notes)
    assert imported.recording.rig.force_is == "commanded"


def test_a_joint_that_is_not_in_a_bag_is_told_with_those_that_are(tmp_path):
    with pytest.raises(
        InputError, match=r"'knee', expected all, or one of its joints \(wrist, elbow\)"
    ):
        import_log(made_bag(tmp_path / "bag", "mcap"), "knee", mapping=bag_map(tmp_path))


def test_without_the_extra_it_says_what_to_install(tmp_path, monkeypatch):
    (tmp_path / "bag").mkdir()
    (tmp_path / "bag" / "metadata.yaml").write_bytes(b"")
    (tmp_path / "log.parquet").write_bytes(b"")
    whole = builtins.__import__

    def without(name, *rest, **more):
        if name.startswith(("rosbags", "pyarrow")):
            raise ImportError(name)
        return whole(name, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", without)
    for log in ("bag", "log.parquet"):
        with pytest.raises(InputError, match=r'pip install "\.\[logs\]" in a clone'):
            import_log(tmp_path / log, "elbow", mapping=bag_map(tmp_path))


def log(folder, mapping=MAPPING, **columns):
    given = {"time_s": [0.0, 0.1, 0.2], "q": [0.0, 0.1, 0.2], "tau": [1.0, 1.0, 1.0]} | columns
    pd.DataFrame(given).to_csv(folder / "log.csv", index=False)
    (folder / "map.toml").write_text(mapping, encoding="utf-8")
    return {"logs": folder / "log.csv", "joint": "elbow", "mapping": folder / "map.toml"}


@pytest.mark.parametrize(
    ("mapping", "columns", "reason"),
    [
        (MAPPING.replace('"tau"', '"torque"'), {}, "torque: expected one of time_s, q, tau"),
        (MAPPING, {"tau": ["1", "x", "2"]}, "row 3, tau: found 'x', expected a number"),
        (MAPPING.replace('"rad"', '"inch"'), {}, "position.unit: found 'inch'"),
        (MAPPING + "\n[clock]\n", {}, "clock"),
        (
            MAPPING + '\n[[runs]]\nname = "a"\nfrom_s = 5\nto_s = 9\n',
            {},
            "runs.a: expected samples",
        ),
        (f"{MAPPING}{RUN}1", {}, "to_s above from_s"),
    ],
)
def test_what_is_wrong_is_told_with_its_place(tmp_path, mapping, columns, reason):
    with pytest.raises(InputError, match=reason):
        import_log(**log(tmp_path, mapping, **columns))


def test_a_log_has_to_be_there(tmp_path):
    given = log(tmp_path) | {"logs": Path(tmp_path / "nowhere.csv")}
    with pytest.raises(InputError, match="expected a log"):
        import_log(**given)


def test_what_cannot_be_estimated_is_said(tmp_path):
    assert "cannot be estimated: the log has it once" in " ".join(import_log(**log(tmp_path)).notes)

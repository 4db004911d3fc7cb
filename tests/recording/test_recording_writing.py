"""What is written reads back the same; it is written whole or not at all."""

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from recording.mini import Mini

from bayesfric.errors import InputError
from bayesfric.recording import Gravity, Recording, RigConstants, read_recording, write_recording


def frames(recording: Recording) -> dict[str, pd.DataFrame]:
    frames_by_name: dict[str, Any] = {"steady": recording.steady}
    for kind in ("gravity", "motor", "axis"):
        tables = getattr(recording, kind)
        frames_by_name |= {f"{kind}.{k}": v for k, v in vars(tables).items()} if tables else {}
    if recording.axis is not None:
        frames_by_name |= {
            f"axis.others.{joint}": of for joint, of in recording.axis.others.items()
        }
    return {
        name: frame for name, frame in frames_by_name.items() if isinstance(frame, pd.DataFrame)
    }


def assert_same(recording: Recording, other: Recording) -> None:
    for name in ("name", "title", "rig", "created", "metadata"):
        assert getattr(recording, name) == getattr(other, name)
    assert frames(recording).keys() == frames(other).keys()
    for name, frame in frames(recording).items():
        pd.testing.assert_frame_equal(frame, frames(other)[name], check_exact=True)


def gravity_recording(spacing: float, clock: float, time: np.ndarray[Any, Any]) -> Recording:
    n = len(time)
    trials = pd.DataFrame(
        {
            "trial": ["t1"],
            "setup": ["s"],
            "pulley_size": ["medium"],
            "n_pulleys": [9],
            "wrap_angle_deg": [85.0],
            "mass_drive_kg": [1.6000000000000003],
            "mass_load_kg": [1 / 3],
        }
    ).astype(dict.fromkeys(("trial", "setup", "pulley_size"), "str"))
    events = pd.DataFrame(
        {
            "trial": ["t1"] * n,
            "sensor": ["drive"] * n,
            "displacement_m": np.arange(n) * spacing,
            "time_s": time,
        }
    ).astype({"trial": "str", "sensor": "str"})
    rig = RigConstants(hall_spacing_m=spacing, magnets_per_revolution=5, timer_resolution_s=clock)
    return Recording("one", "One trial", rig, gravity=Gravity(trials, events))


def test_round_trip_of_all_kinds(tmp_path: Path) -> None:
    mini = Mini()
    mini.package["simulation"] = {"seed": 2**100, "effects": {"viscous": 1.0}}
    recording = read_recording(mini.write(tmp_path / "by hand"))
    write_recording(recording, tmp_path / "a")
    other = read_recording(tmp_path / "a")
    assert_same(recording, other)
    assert other.notes == recording.notes
    write_recording(other, tmp_path / "b")
    names = sorted(path.name for path in (tmp_path / "a").iterdir())
    assert names == sorted(["datapackage.json", *mini.rows])
    for name in names:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    assert read_recording(tmp_path / "b").sha256 == other.sha256


@pytest.mark.parametrize("file", list(Mini().rows))
def test_round_trip_of_each_kind_alone(tmp_path: Path, file: str) -> None:
    recording = read_recording(Mini().kind(file).write(tmp_path / "by hand"))
    write_recording(recording, tmp_path / "a")
    assert_same(recording, read_recording(tmp_path / "a"))


@pytest.mark.parametrize("spacing", [0.0098, 0.01, 1.0, np.pi / 320, 1 / 3, 1.2e-5])
@pytest.mark.parametrize("clock", [4e-6, 1e-3, 2.5e-7])
def test_any_spacing_and_clock(tmp_path: Path, spacing: float, clock: float) -> None:
    # Longer for a wider spacing, so that weights can drive the motion.
    duration = 0.4 * np.sqrt(spacing / 0.0098)
    ticks = np.rint(np.array([25, 9000, 15000, 20000, 24000, 27000]) * duration / 27000 / clock)
    recording = gravity_recording(spacing, clock, ticks * clock)
    write_recording(recording, tmp_path / "a")
    other = read_recording(tmp_path / "a")
    for name, tolerance in (("displacement_m", 0.0), ("time_s", 1e-14)):
        np.testing.assert_allclose(
            frames(other)["gravity.events"][name],
            frames(recording)["gravity.events"][name],
            rtol=tolerance,
        )
    pd.testing.assert_frame_equal(
        frames(recording)["gravity.trials"], frames(other)["gravity.trials"], check_exact=True
    )


def test_printed_digits(tmp_path: Path) -> None:
    times = np.array([25, 9000, 15000, 20000, 24000]) * 4e-6
    write_recording(gravity_recording(0.0098, 4e-6, times), tmp_path / "a")
    assert (tmp_path / "a" / "gravity_events.csv").read_bytes() == (
        b"trial,sensor,displacement_m,time_s\n"
        b"t1,drive,0.0000,0.000100\n"
        b"t1,drive,0.0098,0.036000\n"
        b"t1,drive,0.0196,0.060000\n"
        b"t1,drive,0.0294,0.080000\n"
        b"t1,drive,0.0392,0.096000\n"
    )
    row = (tmp_path / "a" / "gravity_trials.csv").read_text().splitlines()[1]
    assert row == "t1,s,medium,9,85,1.6000000000000003,0.3333333333333333"


def test_keys_that_were_absent_stay_absent(tmp_path: Path) -> None:
    times = np.array([25, 9000, 15000, 20000, 24000]) * 4e-6
    write_recording(gravity_recording(0.0098, 4e-6, times), tmp_path / "a")
    package = json.loads((tmp_path / "a" / "datapackage.json").read_text("utf-8"))
    assert list(package) == ["name", "title", "rig", "resources"]
    assert package["rig"] == {
        "gravity_m_s2": 9.80665,
        "hall_spacing_m": 0.0098,
        "magnets_per_revolution": 5,
        "timer_resolution_s": 4e-06,
    }


def test_times_finer_than_the_clock_keep_their_digits(tmp_path: Path) -> None:
    times = np.array([0.1, 0.2, 0.3, 0.4, 0.5]) + 1.23e-7
    recording = gravity_recording(0.0098, 4e-6, times)
    write_recording(recording, tmp_path / "a")
    assert_same(recording, read_recording(tmp_path / "a"))


def test_units_stand_in_the_table_schema(tmp_path: Path) -> None:
    mini = Mini().without("gravity_trials.csv", "gravity_events.csv")
    for rotary, units in ((False, ["s", "m", "N"]), (True, ["s", "rad", "N·m"])):
        mini.package["rig"]["rotary"] = rotary
        recording = read_recording(mini.write(tmp_path / f"hand {rotary}"))
        write_recording(recording, tmp_path / f"{rotary}")
        package = json.loads((tmp_path / f"{rotary}" / "datapackage.json").read_text("utf-8"))
        samples = package["resources"][-1]["schema"]["fields"]
        assert [field.get("unit") for field in samples[:4]] == [None, *units]
        motor = package["resources"][0]["schema"]["fields"]
        assert [field["unit"] for field in motor if field["name"] == "velocity_m_s"] == ["m/s"]


def test_a_folder_that_is_empty_is_taken(tmp_path: Path) -> None:
    recording = read_recording(Mini().write(tmp_path / "by hand"))
    (tmp_path / "a").mkdir()
    write_recording(recording, tmp_path / "a")
    write_recording(recording, tmp_path / "deep" / "down")
    assert_same(read_recording(tmp_path / "a"), read_recording(tmp_path / "deep" / "down"))


@pytest.mark.parametrize("kind", ["file", "full"])
def test_a_folder_that_is_in_use_is_refused(tmp_path: Path, kind: str) -> None:
    recording = read_recording(Mini().write(tmp_path / "by hand"))
    target = tmp_path / "target"
    if kind == "file":
        target.write_text("mine")
    else:
        target.mkdir()
        (target / "mine.txt").write_text("mine")
    with pytest.raises(InputError) as caught:
        write_recording(recording, target)
    (fault,) = caught.value.faults
    assert fault.file == str(target)
    assert "empty or does not exist" in fault.expected
    assert sorted(path.name for path in tmp_path.iterdir()) == ["by hand", "target"]
    assert (target if kind == "file" else target / "mine.txt").read_text() == "mine"


def test_nothing_is_written_of_a_recording_that_breaks_a_rule(tmp_path: Path) -> None:
    recording = gravity_recording(0.0098, 4e-6, np.array([0.1, 0.2, 0.2, 0.4, np.nan]))
    with pytest.raises(InputError) as caught:
        write_recording(recording, tmp_path / "a")
    faults = [(f.file, f.row, f.column, f.value) for f in caught.value.faults]
    events = "gravity_events.csv"
    assert faults == [(events, 4, "time_s", "0.2"), (events, 6, "time_s", "")]
    assert list(tmp_path.iterdir()) == []


def test_nothing_is_left_of_a_write_that_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    recording = read_recording(Mini().write(tmp_path / "by hand"))
    write = Path.write_bytes

    def full(path: Path, data: bytes) -> int:
        if path.name == "motor_runs.csv":
            raise OSError(28, "No space left on device")
        return write(path, data)

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(InputError, match="No space left on device"):
        write_recording(recording, tmp_path / "a")
    assert [path.name for path in tmp_path.iterdir()] == ["by hand"]


def test_column_that_the_format_does_not_know_is_a_programming_error(tmp_path: Path) -> None:
    recording = read_recording(Mini().write(tmp_path / "by hand"))
    assert recording.gravity is not None
    trials = recording.gravity.trials.assign(colour="red")
    gravity = dataclasses.replace(recording.gravity, trials=trials)
    with pytest.raises(ValueError, match=r"gravity_trials\.csv has no column colour") as caught:
        write_recording(dataclasses.replace(recording, gravity=gravity), tmp_path / "a")
    assert not isinstance(caught.value, InputError)

"""Recordings that look like a mistake and are none: they are read."""

from pathlib import Path

import pytest
from recording.mini import Mini, write_files

from bayesfric.errors import InputError
from bayesfric.recording import describe_recording, read_recording

EVENTS, RUNS, STEADY = "gravity_events.csv", "motor_runs.csv", "steady_friction.csv"
SAMPLES = "axis_samples.csv"


def test_rows_of_nothing_at_the_end_are_passed_over(tmp_path: Path) -> None:
    files = Mini().contents()
    plain = read_recording(write_files(tmp_path / "plain", files))
    files[RUNS] += b",,,,,,,,,\n" * 3 + b"\n\n"
    recording = read_recording(write_files(tmp_path / "more", files))
    assert recording.motor is not None
    assert plain.motor is not None
    assert recording.motor.runs.equals(plain.motor.runs)


def test_one_outlier_of_a_current_or_a_friction_is_data(tmp_path: Path) -> None:
    mini = Mini().keep(STEADY)
    header, row, other = mini.rows[STEADY]
    mini.rows[STEADY] = [header, *([f"r{k}", *row[1:]] for k in range(4)), other]
    mini.drop(STEADY, "order").set(STEADY, 6, "friction_n", "31")
    read_recording(mini.write(tmp_path))


def test_many_pulleys_at_their_angle_are_not_swapped(tmp_path: Path) -> None:
    mini = Mini().keep(STEADY)
    for line in (2, 3):
        mini.set(STEADY, line, "n_pulleys", "50").set(STEADY, line, "wrap_angle_deg", "20")
    read_recording(mini.write(tmp_path))


def test_a_missed_event_is_no_fault_of_motion(tmp_path: Path) -> None:
    """One interval twice as long is data, whatever it does to an acceleration."""
    mini = Mini()
    for line, time in ((4, "0.23"), (5, "0.265"), (6, "0.295")):
        mini.set(EVENTS, line, "time_s", time)
    read_recording(mini.write(tmp_path))


def test_angles_of_zero_alone_are_no_radians(tmp_path: Path) -> None:
    mini = Mini().keep(STEADY)
    for line in (2, 3):
        mini.set(STEADY, line, "wrap_angle_deg", "0")
    read_recording(mini.write(tmp_path))


def test_a_stronger_cable_may_bear_more(tmp_path: Path) -> None:
    mini = Mini().keep(STEADY).set(STEADY, 2, "tension_n", "400")
    with pytest.raises(InputError, match="311 N"):
        read_recording(mini.write(tmp_path))
    mini.package["rig"]["limits"]["tension_n"] = [0, 500]
    read_recording(mini.write(tmp_path))


def test_an_axis_that_turns_or_says_how_far_it_goes_may_go_far(tmp_path: Path) -> None:
    mini = Mini().keep("axis_runs.csv", SAMPLES).set(SAMPLES, 4, "position_m", "300")
    with pytest.raises(InputError, match=r"rig\.limits\.travel_m"):
        read_recording(mini.write(tmp_path))
    mini.package["rig"]["limits"]["travel_m"] = [0, 400]
    read_recording(mini.write(tmp_path))
    mini.package["rig"] |= {"rotary": True, "limits": {}}
    turns = describe_recording(read_recording(mini.write(tmp_path)))
    assert "0.02 s and 300 rad (17,188.7°) a run" in dict(turns)["  log"]

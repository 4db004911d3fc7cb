"""The same measurement under several ids is said, and counts once; honest repeats stay."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from recording.mini import Mini

from bayesfric.recording import Recording, read_recording

TRIALS, EVENTS, RUNS = "gravity_trials.csv", "gravity_events.csv", "motor_runs.csv"
STEADY, SAMPLES = "steady_friction.csv", "axis_samples.csv"


def steady(tmp_path: Path, friction: list[str], tension: list[str]) -> Recording:
    """Points with these readings, as they are printed."""
    mini = Mini().keep(STEADY)
    rows = [[f"p{k}", t, f] for k, (f, t) in enumerate(zip(friction, tension, strict=True))]
    mini.rows[STEADY] = [["run", "tension_n", "friction_n"], *rows]
    return read_recording(mini.write(tmp_path))


def left(recording: Recording) -> list[str]:
    assert recording.steady is not None
    return list(recording.steady["run"])


def printed(rng: np.random.Generator, size: int, digits: int) -> list[str]:
    return [f"{value:.{digits}f}" for value in rng.normal(0.7, 0.014, size)]


def test_a_table_pasted_six_times_is_there_once(tmp_path: Path) -> None:
    block = printed(np.random.default_rng(1), 8, 4)
    tension = [str(t) for t in range(5, 13)]
    recording = steady(tmp_path, 6 * block, 6 * tension)
    assert left(recording) == [f"p{k}" for k in range(8)]
    (note,) = recording.notes
    assert note.startswith("steady_friction.csv: run p8 of p0, p9 of p1, p10 of p2,")
    assert note.endswith("and 30 more: exact copies, used once")


def test_one_reading_of_many_digits_that_stands_twice_is_a_copy(tmp_path: Path) -> None:
    recording = steady(tmp_path, ["0.70312847", "0.7", "0.70312847"], ["5", "5", "5"])
    assert left(recording) == ["p0", "p1"]
    assert recording.notes == ("steady_friction.csv: run p2 of p0: an exact copy, used once",)


def test_the_same_reading_at_another_tension_is_no_copy(tmp_path: Path) -> None:
    assert len(left(steady(tmp_path, ["0.70312847", "0.70312847"], ["5", "6"]))) == 2


@pytest.mark.parametrize("digits", [2, 3])
def test_rounded_readings_repeat_honestly(tmp_path: Path, digits: int) -> None:
    """300 repeats of five conditions: by chance many are alike, and none is a copy."""
    rng = np.random.default_rng(2)
    recording = steady(tmp_path, printed(rng, 1500, digits), 300 * ["5", "6", "7", "8", "9"])
    assert len(left(recording)) == 1500
    assert recording.notes == ()


def test_a_bench_finer_than_its_display_repeats_honestly(tmp_path: Path) -> None:
    """Its readings repeat in whole blocks, since all of them are rounded to two digits."""
    assert len(left(steady(tmp_path, 9 * ["0.70", "0.80", "0.90"], 9 * ["5", "6", "7"]))) == 27


@pytest.mark.parametrize("later", ["", "5."])
def test_a_trial_with_the_events_of_another_counts_once(tmp_path: Path, later: str) -> None:
    """On a clock that began anew, too; under another setup, too."""
    mini = Mini().keep(TRIALS, EVENTS)
    copy = mini.rows[TRIALS][1].copy()
    copy[:3] = ["g9", "9", "c"]
    mini.rows[TRIALS].append(copy)
    for row in mini.rows[EVENTS][1:11]:
        time = row[3] if not later else f"{float(row[3]) + 5:.6f}"
        mini.rows[EVENTS].append(["g9", *row[1:3], time])
    recording = read_recording(mini.write(tmp_path))
    assert recording.gravity is not None
    assert list(recording.gravity.trials["trial"]) == ["g1", "g2", "g3"]
    assert "g9" not in set(recording.gravity.events["trial"])
    assert recording.notes == ("gravity_trials.csv: trial g9 of g1: an exact copy, used once",)


def test_the_same_events_under_another_condition_are_kept_and_said(tmp_path: Path) -> None:
    mini = Mini().keep(TRIALS, EVENTS)
    copy = mini.rows[TRIALS][1].copy()
    copy[:3], copy[6] = ["g9", "9", "c"], "1.61"
    mini.rows[TRIALS].append(copy)
    mini.rows[EVENTS] += [["g9", *row[1:]] for row in mini.rows[EVENTS][1:11]]
    recording = read_recording(mini.write(tmp_path))
    assert recording.gravity is not None
    assert len(recording.gravity.trials) == 4
    assert recording.notes[0].startswith("gravity_trials.csv: g9 and g1 have the same events")


def test_runs_of_the_motor_board_that_are_pasted_twice_count_once(tmp_path: Path) -> None:
    mini = Mini().keep(RUNS, "motor_idle.csv").set(RUNS, 2, "current_a", "4.103127")
    mini.set(RUNS, 3, "current_a", "3.402881")
    mini.rows[RUNS] += [["m3", "3", "y", *row[3:]] for row in mini.rows[RUNS][1:2]]
    mini.rows[RUNS] += [["m4", "4", "y", *row[3:]] for row in mini.rows[RUNS][2:3]]
    recording = read_recording(mini.write(tmp_path))
    assert recording.motor is not None
    assert list(recording.motor.runs["run"]) == ["m1", "m2"]


def test_runs_of_a_joint_with_the_same_samples_count_once(tmp_path: Path) -> None:
    mini = Mini().keep("axis_runs.csv", SAMPLES).drop("axis_runs.csv", "payload_kg")
    rng = np.random.default_rng(3)
    names = mini.rows[SAMPLES][0]
    log = pd.DataFrame({name: rng.normal(size=20).round(4) for name in names[2:]})
    log = log.assign(time_s=np.arange(20) * 0.01, temperature_c=20.0, joint="q1")
    log = log.assign(force_time_s=log.time_s, command_time_s=log.time_s)
    text = log[names[1:]].astype(str).to_numpy().tolist()
    mini.rows[SAMPLES] = [names, *([run, *row] for run in ("r1", "r2") for row in text)]
    recording = read_recording(mini.write(tmp_path))
    assert recording.axis is not None
    assert list(recording.axis.runs["run"]) == ["r1"]
    assert len(recording.axis.samples) == 20
    assert "axis_runs.csv: run r2 of r1: an exact copy, used once" in recording.notes

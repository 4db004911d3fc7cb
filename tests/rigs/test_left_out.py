"""What does not enter is told with its rule and its numbers, by every verb and by validate."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

from bayesfric.cli import app
from bayesfric.recording import Axis, Recording, RigConstants, write_recording
from bayesfric.rigs.opening import left_out

pytestmark = pytest.mark.usefixtures("lengths_not_searched")
RATE = 200.0


def joint(motion, seconds=6.0, rate=RATE, runs=1, **columns):
    """A log of a joint of 2 kg with 1.5 N of Coulomb friction."""
    rng = np.random.default_rng(1)
    time = np.arange(0, seconds, 1 / rate)
    samples = []
    for run in range(runs):
        position = motion(time + run) + 1e-5 * rng.standard_normal(time.size)
        speed = np.gradient(position, time)
        force = 2.0 * np.gradient(speed, time) + 1.5 * np.sign(speed)
        log = {"run": f"r{run}", "time_s": time, "position_m": position, "force_n": force}
        samples.append(pd.DataFrame(log))
    table = pd.DataFrame({"run": [f"r{run}" for run in range(runs)]})
    joined = pd.concat(samples, ignore_index=True).assign(**columns)
    return Recording("joint", "A joint", RigConstants(), axis=Axis(table, joined))


def fast(time):
    """Ten samples at 20 Hz from one end to the other."""
    return 0.2 * np.sin(2 * np.pi * time)


def slow(time):
    return 0.2 * np.sin(0.8 * time)


def stderr_of(recording, tmp_path, verb):
    """Return what a verb says, on both streams."""
    folder = tmp_path / "joint"
    if not folder.exists():
        write_recording(recording, folder)
    further = [] if verb == "validate" else ["-o", str(tmp_path / "out"), "--quiet"]
    done = CliRunner().invoke(app, [verb, str(folder), *further])
    assert done.exit_code == (0 if verb == "validate" else 2), done.output
    return done.stderr


CASES = {
    "few samples": (joint(slow, seconds=0.05), "a run takes 16 samples, and the longest has 10"),
    "too slow a log": (joint(fast, rate=20.0), "which has 7 samples, and 16 are needed"),
    "held": (joint(lambda time: 0 * time), "never shows which way the axis runs"),
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("verb", ["validate", "fit", "diagnose"])
def test_a_run_that_does_not_enter_is_told_why(tmp_path, case, verb):
    recording, said = CASES[case]
    text = stderr_of(recording, tmp_path, verb)
    assert "axis_samples.csv: expected a run that can be used" in text
    assert said in text


def test_many_runs_are_told_in_few_lines():
    """Beside one run that enters, each of fifty short ones is named with its rule."""
    whole, short = joint(slow), joint(slow, seconds=0.05, runs=50)
    samples = whole.axis.samples.replace({"run": {"r0": "whole"}})
    runs = pd.concat([pd.DataFrame({"run": ["whole"]}), short.axis.runs], ignore_index=True)
    samples = pd.concat([samples, short.axis.samples], ignore_index=True)
    faults = left_out(replace(whole, axis=Axis(runs, samples)))
    assert len(faults) == 20
    assert faults[-1].like == 30
    assert "run r0: found '10 samples', expected at least 16 samples in a run" in str(faults[0])


@pytest.mark.parametrize(
    ("logged", "told_of"),
    [
        (["r1"], "a, run r0: expected 16 samples at least of joint b too"),
        ([], "a: expected a run that can be used: no run has 16 samples of every joint: r0 lacks"),
    ],
)
def test_a_run_without_another_joint_is_told_with_that_joint(logged, told_of):
    """It has samples enough of its own; what the other does to it is not known."""
    recording = joint(slow, runs=2)
    samples, runs = recording.axis.samples, recording.axis.runs
    beside = samples[samples["run"].isin([*logged, "r2"])].assign(joint="b")
    if not logged:  # the other joint has a run of its own
        beside = samples[samples["run"] == "r1"].assign(joint="b", run="r2")
        runs = pd.DataFrame({"run": ["r0", "r1", "r2"]})
    log = pd.concat([samples.assign(joint="a"), beside], ignore_index=True)
    faults = left_out(replace(recording, axis=Axis(runs, log)))
    assert any(told_of in str(fault) for fault in faults), faults


def test_a_log_that_enters_says_nothing(tmp_path):
    assert stderr_of(joint(slow), tmp_path, "validate") == ""


def test_commands_that_never_change_tell_nothing(tmp_path):
    recording = joint(lambda time: 0 * time, command_m=0.0)
    samples = recording.axis.samples.drop(columns="force_n")
    recording = replace(recording, axis=replace(recording.axis, samples=samples))
    assert "never shows which way the axis runs" in stderr_of(recording, tmp_path, "fit")


def test_a_known_force_of_nothing_and_a_clock_that_agrees_change_nothing(tmp_path):
    recording = joint(slow, known_force_n=0.0, force_time_s=lambda log: log.time_s, joint="q1")
    assert "left out" not in stderr_of(recording, tmp_path, "validate")


def test_a_trial_of_the_board_that_a_rule_leaves_out_is_told(small_recording, tmp_path):
    events = small_recording.gravity.events
    trial = events["trial"].iloc[0]
    own = events["trial"] == trial
    rng = np.random.default_rng(2)
    shaken = events["time_s"].where(~own, np.sort(rng.uniform(0, 1, len(events))))
    gravity = replace(small_recording.gravity, events=events.assign(time_s=shaken))
    (fault,) = left_out(replace(small_recording, gravity=gravity))
    assert str(fault).startswith(
        f"gravity_trials.csv, {trial}: expected a trial that enters; unrep"
    )

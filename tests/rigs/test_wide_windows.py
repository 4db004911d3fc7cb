"""Over wide windows the mean of a speed is the mean that the force is."""

import numpy as np
import pytest
from rigs.loaded_joints import LoadedJoint

from bayesfric.rigs.single_axis.on_time import margin_s, on_time
from bayesfric.rigs.single_axis.run_rows import rows_of_run
from bayesfric.rigs.single_axis.simulated import log_of
from bayesfric.rigs.single_axis.weak_form import test_function as of_window
from bayesfric.rigs.single_axis.windows import joined

JOINT = LoadedJoint(runs=2, seconds=12.0, sampled_hz=100.0, gravity=0.0, offset=0.07, viscous=0.12)


def logs_of(joint):
    recording = joint.recording()
    runs = recording.axis.samples.groupby("run", sort=False)
    return [log_of(samples.reset_index(drop=True), recording.rig) for _, samples in runs]


def test_the_mean_speed_of_a_window_is_under_its_test_function():
    log, test = logs_of(JOINT)[0], of_window(22, 0.01)
    part = rows_of_run(log, test, 4, 1e-5, 2.4)
    speed = np.abs(JOINT.run(0)[2])
    exact = test.over(speed, test.value, part["centre"].astype(int))
    assert joined([part], "speed") == pytest.approx(exact, abs=2e-3 * speed.max())


def test_a_force_on_time_is_not_moved():
    """Its viscous friction, by another mean of the speed, seemed to come 16 ms late."""
    found = on_time(logs_of(JOINT), None, margin_s(0.01))
    assert found.late_s == 0.0

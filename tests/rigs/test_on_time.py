"""A force that stands in the log at another time than the one at which it acted."""

import numpy as np
import pandas as pd
import pytest
from rigs.joints import Joint, recording_of
from rigs.looped_joint import LoopedJoint

from bayesfric.rigs import all_rigs

pytestmark = pytest.mark.usefixtures("lengths_not_searched")
AXIS = all_rigs()["single-axis"]
CLOSED = {"stiffness": 15.0, "damping": 1.0}
LATE = {
    "half a second": LoopedJoint(sampled_hz=200.0, closed=False, late_s=0.5),
    "a tenth, in a loop": LoopedJoint(sampled_hz=200.0, late_s=0.1, **CLOSED),
    "four fifths, counts of 1e-3": LoopedJoint(sampled_hz=200.0, count=1e-3, late_s=0.8, **CLOSED),
}


@pytest.mark.parametrize(
    "joint",
    [
        pytest.param(LATE["half a second"], marks=pytest.mark.nightly),
        *(LATE[name] for name in [*LATE][1:]),
    ],
    ids=LATE,
)
def test_a_force_that_telemetry_has_late_is_set_right(joint):
    runs = AXIS.trials(joint.recording())
    assert runs.late_s == pytest.approx(joint.late_s, abs=2e-3)
    rough = runs._rough
    assert rough.mass == pytest.approx(joint.inertia, rel=0.03)
    assert rough.coulomb == pytest.approx(joint.coulomb, rel=0.03)
    assert f"The force acts {runs.late_s:.3g} s later" in " ".join(runs.doubts({}))


def test_a_sensor_that_is_slow_is_set_right_too():
    """What it reads acted 30 ms ago: no drive acts before it is told to."""
    joint = LoopedJoint(sampled_hz=200.0, **CLOSED)
    samples = joint.recording().axis.samples
    for _, rows in samples.groupby("run"):
        time, sent = rows["time_s"].to_numpy(), rows["force_n"].to_numpy()
        samples.loc[rows.index, "force_n"] = np.interp(time - 0.03, time, sent)
    runs = AXIS.trials(recording_of(samples, force_is="motor"))
    assert runs.late_s == pytest.approx(-0.0275, abs=2e-3)  # a command acts 2.5 ms later itself
    assert runs._rough.mass == pytest.approx(joint.inertia, rel=0.03)


def test_what_a_drive_may_be_late_by_is_left_to_the_effects():
    for joint in (Joint(), LoopedJoint(sampled_hz=200.0, late_s=0.02, **CLOSED)):
        assert AXIS.trials(joint.recording()).late_s == 0.0


def test_a_tenth_of_a_second_is_no_lag():
    """A drive that lags by as much bends the force almost alike where the joint is slow."""
    runs = AXIS.trials(LoopedJoint(sampled_hz=200.0, closed=False, late_s=0.1).recording())
    assert runs.late_s == pytest.approx(0.1, abs=2e-3)


def test_runs_too_short_for_a_force_to_be_moved_have_it_as_logged():
    """Sixteen samples: no window stays inside of the run however the force is moved."""
    samples = LoopedJoint(sampled_hz=200.0, **CLOSED).recording().axis.samples
    (fault,) = AXIS.left_out(recording_of(samples.iloc[:16]))
    assert "and 8 are needed: record it for longer" in fault.expected


def pulsed(seconds=16.0, step=0.01, fine=10):
    """Return samples of a joint that coasts to rest after each pulse of torque."""
    inertia, coulomb, viscous, place, speed, log = 0.02, 0.4, 0.15, 0.0, 0.0, []
    for tick in range(int(seconds / step)):
        time = step * tick
        force = 1.5 * ((time % 4 < 0.4) - 1.0 * (2 < time % 4 < 2.4))
        log.append(("a", time, 2e-4 * round(place / 2e-4), force))
        for _ in range(fine):
            span = step / fine
            speed += span * (force - viscous * speed) / inertia
            speed = np.sign(speed) * max(0.0, abs(speed) - span * coulomb / inertia)
            place += span * speed
    return pd.DataFrame(log, columns=["run", "time_s", "position_m", "force_n"])


def test_a_shift_by_a_pause_explains_no_pulse():
    """Shifted by 1.1 s the force was 0 wherever the joint moves, and the log was refused."""
    runs = AXIS.trials(recording_of(pulsed(), force_is="commanded"))
    assert runs.late_s == 0.0
    assert runs._rough.mass == pytest.approx(0.02, rel=0.03)
    assert runs._rough.coulomb == pytest.approx(0.4, rel=0.03)


@pytest.mark.parametrize("late_s", [-1.13, 1.13])
def test_a_force_that_is_later_than_is_looked_for_is_refused(late_s):
    """Beside the farthest delay the squares still fall: no law of this log is right."""
    samples = Joint(sampled_hz=100.0, seconds=12.0, rates_hz=(0.31, 0.83), gravity=0.0).samples()
    time, force = samples["time_s"].to_numpy(), samples["force_n"].to_numpy()
    moved = samples.assign(force_n=np.interp(time + late_s, time, force))
    (fault,) = AXIS.left_out(recording_of(moved, force_is="measured"))
    acts = "later" if late_s > 0 else "earlier"
    assert f"fits best where it acts 1.1 s {acts} than it was logged" in fault.expected

"""The log of a joint as telemetry leaves it: commands in steps, holds, late rows, own clocks."""

import numpy as np
import pytest
from rigs.joints import recording_of
from rigs.looped_joint import LoopedJoint

from bayesfric.recording.held import released, stale
from bayesfric.rigs import all_rigs
from bayesfric.rigs.single_axis.even_log import even_grid
from bayesfric.rigs.single_axis.force_faults import clipped, spikes
from bayesfric.rigs.single_axis.weak_form import test_function as bump

pytestmark = pytest.mark.usefixtures("lengths_not_searched")
AXIS = all_rigs()["single-axis"]


def rough_of(recording):
    return AXIS.trials(recording)._rough


def near(joint, rough, within=0.03):
    assert rough.mass == pytest.approx(joint.inertia, rel=within)
    assert rough.coulomb == pytest.approx(joint.coulomb, rel=within)
    assert rough.viscous == pytest.approx(joint.viscous, rel=3 * within)


def stepped(time, sent, at):
    """Return what acts at some times: the last command that was sent."""
    return sent[np.clip(np.searchsorted(time, at, side="right") - 1, 0, None)]


@pytest.mark.parametrize("jitter", [0.0, 0.4])
def test_a_command_is_integrated_as_it_is_held(jitter):
    rng = np.random.default_rng(1)
    interval = 0.01
    time = interval * (np.arange(400) + jitter * rng.uniform(-0.5, 0.5, 400))
    sent = np.sin(9 * time) + 0.5 * rng.standard_normal(400)
    log = even_grid(time, {"position": time, "force": sent}, steps=True)
    test, centres = bump(12, log.interval_s), np.arange(20, 380, 9)
    averages = test.over(log.force, test.value, centres)
    fine = np.linspace(-1, 1, 40001)
    weight = (1 - fine**2) ** 3
    width = 13 * log.interval_s
    expected = [
        np.average(stepped(time, sent, log.time_s[centre] + width * fine), weights=weight)
        for centre in centres
    ]
    np.testing.assert_allclose(averages, expected, atol=0.012)  # half a sample late: 0.05


def test_commands_at_100_hz_and_jitter_leave_the_law_as_it_is():
    joint = LoopedJoint(sampled_hz=100.0, count=1e-3, stiffness=8.0, damping=0.6, jitter=0.4)
    near(joint, rough_of(joint.recording()))


def test_the_force_of_a_motor_that_telemetry_holds_goes_on_to_its_next_reading():
    """Held for eight samples it is 7 ms late in the mean; a drive's command would act so."""
    joint = LoopedJoint(force_held=8, closed=False)
    recording = joint.recording(force_is="motor")
    run = recording.axis.samples[recording.axis.samples["run"] == "r0"]
    assert "force for 8 samples" in released(run, "motor")[1]
    near(joint, rough_of(recording))


def test_forces_between_two_positions_that_are_held_all_count():
    """A controller at 500 Hz, its position logged every 20 ms: nine of ten forces were lost."""
    joint = LoopedJoint(count=1e-3)
    samples = joint.recording().axis.samples
    samples["position_m"] = samples.groupby("run")["position_m"].transform(
        lambda column: column.to_numpy()[np.arange(len(column)) // 10 * 10]
    )
    near(joint, rough_of(recording_of(samples, force_is="commanded")))


def test_a_force_that_is_held_like_the_position_is_no_step():
    """Taken for a command that acts as it stands there, it would be 10 ms late in the mean."""
    joint = LoopedJoint(held=10, stiffness=15.0, damping=0.3)
    near(joint, rough_of(joint.recording()))


def late_rows(samples, share=0.1, seed=3):
    """Return samples of which some repeat the row before, as if the new one came too late."""
    again = np.random.default_rng(seed).random(len(samples)) < share
    again[0] = False
    kept = np.maximum.accumulate(np.where(again, 0, np.arange(len(samples))))
    columns = ["position_m", "force_n"]
    return samples.assign(**{name: samples[name].to_numpy()[kept] for name in columns}), again


def test_rows_that_came_too_late_are_found_and_counted():
    samples, again = late_rows(LoopedJoint(sampled_hz=200.0, closed=False).samples())
    repeats = stale(samples["position_m"].to_numpy(), samples["force_n"].to_numpy())
    assert (repeats == again).mean() > 0.99
    assert f"{repeats.sum():,} of 3,000 rows repeat the one before" in released(samples, None)[1]
    for coarse in (LoopedJoint(count=1e-2, closed=False), LoopedJoint(count=1e-3)):
        log = coarse.samples()
        assert not stale(log["position_m"].to_numpy(), log["force_n"].to_numpy()).any()


@pytest.mark.parametrize("zero_s", [0.0, 7000.0])
def test_a_force_on_a_clock_of_its_own_is_read_by_it(zero_s):
    """It comes now more, now less after the position; the zero of its clock is any instant."""
    joint = LoopedJoint(sampled_hz=100.0, stiffness=8.0, damping=0.6)
    samples = joint.recording().axis.samples
    late = 0.005 + 0.002 * np.random.default_rng(1).uniform(-1, 1, len(samples))
    # The command of a row acts through the interval that begins there: in the mean 5 ms later.
    at_own = samples.assign(force_time_s=samples["time_s"] + late + zero_s)
    # Of a clock with another zero it is only known that the two go alike: 5 ms are not seen.
    near(joint, rough_of(recording_of(at_own, force_is="motor")), 0.05 if zero_s else 0.03)


def test_spikes_of_a_sensor_are_counted_and_steps_and_swings_are_none():
    rng = np.random.default_rng(4)
    time = 0.003 * np.arange(1200)
    smooth = np.sin(5 * time) + 0.02 * rng.standard_normal(1200)
    assert spikes(smooth) == 0.0
    off = rng.random(1200) < 0.06
    assert spikes(smooth + 5.0 * off * rng.choice([-1, 1], 1200)) == pytest.approx(0.06, abs=0.015)
    assert spikes(smooth + np.sign(np.sin(40 * time))) == 0.0
    assert spikes(smooth + 0.5 * (-1.0) ** np.arange(1200)) == 0.0
    assert spikes(np.zeros(1200)) == 0.0


@pytest.mark.parametrize("limit", [0.6, np.inf])
def test_readings_at_the_end_of_a_range_are_known(limit):
    """A force that a sensor cuts off at 0.6 N·m told an inertia of 0.033 for 0.060."""
    time = np.arange(0, 20, 0.005)
    force = 0.7 * np.sin(2 * np.pi * 0.23 * time) + 0.3 * np.sin(2 * np.pi * 0.61 * time)
    read = np.clip(force + np.random.default_rng(1).normal(0, 0.01, time.size), -limit, limit)
    assert clipped(read).mean() == pytest.approx(np.mean(np.abs(force) >= limit), abs=0.01)


@pytest.mark.parametrize("step", [0.0, 0.02, 0.2])
def test_counts_of_a_current_and_a_drive_that_is_off_are_no_end_of_a_range(step):
    time = np.arange(0, 20, 0.005)
    force = np.sin(2 * np.pi * 0.23 * time) + np.random.default_rng(1).normal(0, 0.01, time.size)
    assert not clipped(np.round(force / step) * step if step else np.minimum(force, 0.0)).any()

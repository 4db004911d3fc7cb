"""Over wide windows the mean of a speed is the mean that the force is."""

from dataclasses import replace

import numpy as np
import pytest
from rigs.loaded_joints import LoadedJoint

from bayesfric.rigs.single_axis.even_log import EvenLog
from bayesfric.rigs.single_axis.on_time import margin_s, on_time
from bayesfric.rigs.single_axis.readings import readings_of, rough_law_of
from bayesfric.rigs.single_axis.run_rows import rows_of_run
from bayesfric.rigs.single_axis.simulated import log_of
from bayesfric.rigs.single_axis.weak_form import WeakForce
from bayesfric.rigs.single_axis.weak_form import test_function as of_window
from bayesfric.rigs.single_axis.windows import joined, window_width

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
    timing = on_time(logs_of(JOINT), None, margin_s(0.01))
    assert timing.late_s == 0.0


@pytest.mark.parametrize("is_known_exactly", [False, True])
def test_windows_are_wide_where_a_known_force_tells_the_acceleration_better(is_known_exactly):
    """Counts of 4e-5 rad at 500 Hz told a rotor's inertia as 0.004 for 0.014: a share took it."""
    time, turned = np.arange(0, 9, 0.002), np.multiply.outer(np.arange(0, 9, 0.002), [1.4, 4.0])
    place, count = np.sin(turned) @ [0.8, 0.3], 4e-5
    of_link = -0.04 * np.sin(turned) @ [0.8 * 1.4**2, 0.3 * 4.0**2]
    speed = np.cos(turned) @ [0.8 * 1.4, 0.3 * 4.0]
    force = 1.35 * of_link + 0.45 * np.sign(speed) + 0.16 * speed
    everywhere = np.ones(time.size, dtype=bool)
    log = EvenLog(time, np.round(place / count) * count, force, everywhere, 0.002, {})
    if is_known_exactly:
        share = (WeakForce(0.025 * of_link),)
        log = replace(log, known_force=WeakForce(of_link), beside=share)
    half_s, _ = window_width([log], count / 12**0.5, 2.0)
    assert (half_s > 0.03) is is_known_exactly


@pytest.mark.parametrize("late_s", [0.0, 0.001])
def test_errors_of_positions_do_not_tell_by_how_much_a_known_force_is_wrong(late_s):
    """It is the acceleration without their errors: its share took a part of the rotor's inertia."""
    time, count, link = np.arange(0, 9, 0.002), 4e-5, 0.04
    of_rates = [0.8 * 1.4**2, 0.3 * 4.0**2]
    turned = np.multiply.outer(time, [1.4, 4.0])
    place, speed = np.sin(turned) @ [0.8, 0.3], np.cos(turned) @ [0.8 * 1.4, 0.3 * 4.0]
    of_link = -link * np.sin(turned) @ of_rates
    force = 1.35 * of_link + 0.45 * np.sign(speed) + 0.16 * speed
    gravity_force = -link * np.sin(turned - late_s * np.array([1.4, 4.0])) @ of_rates
    everywhere = np.ones(time.size, dtype=bool)
    log = EvenLog(time, np.round(place / count) * count, force, everywhere, 0.002, {})
    share = (WeakForce(0.025 * gravity_force),)
    log = replace(log, known_force=WeakForce(gravity_force), beside=share, known_to_a_share=True)
    rows = readings_of([log], [np.zeros(1, dtype=int)], count)
    speed = rows.speed @ rows.weights
    law = np.column_stack([rows.acceleration, np.ones(rows.count), speed, rows.way])
    share, errors, clock = (rows.beside @ rows.mixing.shares).T
    own = law @ np.linalg.lstsq(law, share, rcond=None)[0]
    assert share == pytest.approx(own, abs=1e-5 * np.abs(own).max())
    assert np.linalg.lstsq(law, own, rcond=None)[0][0] == pytest.approx(0.025 * link, rel=2e-3)
    assert np.abs(errors).max() < 1e-2 * np.abs(share).max()
    # Its clock may be off as that of the force may: by a millisecond, and a part of an interval.
    rate = (
        -link
        * np.cos(np.multiply.outer(rows.time_s - late_s, [1.4, 4.0]))
        @ (np.array(of_rates) * [1.4, 4.0])
    )
    assert clock == pytest.approx(
        margin_s(0.002) * rows.way * rate, abs=0.02 * margin_s(0.002) * np.abs(rate).max()
    )


def test_windows_are_wide_where_a_weight_pulls_as_the_acceleration_goes():
    """In a free swing errors of counts made an inertia of 0.0005, which asked for no wider one."""
    step, count, inertia, fine = 0.005, 2.9e-3, 0.3, 10
    place, speed, places, forces = 0.0, 0.0, [], []
    for tick in range(int(12 / step) * fine):
        time = tick * step / fine
        force = 0.3 * np.sin(4.0 * time) + 0.1 * np.sin(2.7 * time)
        if tick % fine == 0:
            places.append(place)
            forces.append(force)
        speed += step / fine * (force - 5.0 * np.sin(place) - 0.02 * speed) / inertia
        speed = np.sign(speed) * max(0.0, abs(speed) - step / fine * 0.05 / inertia)
        place += step / fine * speed
    force = np.array(forces) + np.random.default_rng(3).normal(0, 0.05, len(forces))
    read = np.round(np.array(places) / count) * count
    log = EvenLog(step * np.arange(read.size), read, force, np.ones(read.size, bool), step, {})
    rows = readings_of([log], [np.zeros(1, dtype=int)], count)
    assert rough_law_of(rows, np.ones(rows.count, dtype=bool)).mass == pytest.approx(0.3, rel=0.3)

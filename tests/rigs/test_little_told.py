"""Motions that tell less than it seems: part of a swing again and again, or one speed."""

from dataclasses import fields, replace

import numpy as np
import pandas as pd
import pytest
from rigs.joints import Joint, recording_of

from bayesfric.physics.laws import BASELINES
from bayesfric.rigs import all_rigs
from bayesfric.rigs.single_axis.trials import opened

pytestmark = pytest.mark.usefixtures("lengths_not_searched")
STEP = 4e-4  # of the encoder [rad]


def opened_of(position, force, rate_hz):
    table = {"run": "a", "time_s": np.arange(position.size) / rate_hz, "force_n": force}
    table["position_m"] = STEP * np.round(position / STEP)
    recording = recording_of(pd.DataFrame(table), force_is="motor")
    return opened(all_rigs()["single-axis"], recording.axis, recording.rig)


def stops_and_goes():
    """Return a joint that goes there, rests, and comes back, by half a sine of speed each time."""
    time, rate = np.arange(1000) / 100, np.pi / 1.2
    phase, there = np.minimum(time % 2, 1.2), (time // 2) % 2 == 0
    travel, moves = (1 - np.cos(rate * phase)) * 0.57, time % 2 < 1.2
    position = np.where(there, travel, 1.14 - travel)
    way = np.where(there, 1, -1) * moves
    speed, acceleration = 0.57 * rate * np.sin(rate * phase), 0.57 * rate**2 * np.cos(rate * phase)
    force = way * (0.06 * acceleration + 0.05 * speed + 0.18) + np.sin(position)
    force += 0.005 * np.random.default_rng(3).standard_normal(time.size)
    return opened_of(position, force, 100)


def test_inertia_is_not_told_where_the_acceleration_is_a_curve_over_the_place():
    trials = stops_and_goes()
    assert trials.readings.independent_acceleration_share < 0.5
    assert "mass" in trials.untold
    assert "the acceleration is nearly a function of the position" in " ".join(trials.doubts({}))


def test_inertia_is_told_where_it_swings_through():
    recording = Joint(seconds=6.0, sampled_hz=100.0).recording()
    trials = opened(all_rigs()["single-axis"], recording.axis, recording.rig)
    assert trials.readings.independent_acceleration_share > 0.99
    assert not trials.untold
    assert not trials.doubts({})


def test_at_one_speed_the_rough_mass_is_none_and_friction_is_one_number():
    time = np.arange(1500) / 100
    way = np.where((time // 5) % 2 == 0, 1.0, -1.0)
    position = np.cumsum(0.4 * way) / 100
    trials = opened_of(position, np.sin(position) + 0.2 * way, 100)
    assert trials.measures.mass < 0.1
    assert "one speed, 0.4 rad/s" in " ".join(trials.doubts({}))
    assert "one speed" not in " ".join(trials.under(BASELINES["coulomb"]).doubts({}))


def test_what_pulls_in_swings_that_are_alike_is_counted_in_what_a_weight_may_pull():
    """Of one sine inertia takes the place of gravity, and friction is no measure of it."""
    recording = Joint(
        rates_hz=(0.5,), strokes_rad=(0.8,), seconds=4.0, sampled_hz=100.0
    ).recording()
    trials = opened(all_rigs()["single-axis"], recording.axis, recording.rig)
    assert trials.readings.swings_alike
    assert trials.measures.pull > 0.4
    assert not trials.untold


def test_few_rows_are_no_curve_over_the_place():
    """Five numbers fit fifteen rows or fewer of anything."""
    recording = Joint(seconds=6.0, sampled_hz=100.0).recording()
    readings = opened(all_rigs()["single-axis"], recording.axis, recording.rig).readings
    few = replace(
        readings,
        **{
            item.name: getattr(readings, item.name)[:14]
            for item in fields(readings)
            if isinstance(getattr(readings, item.name), np.ndarray)
        },
    )
    assert not few.swings_alike
    assert few.independent_acceleration_share == 1.0

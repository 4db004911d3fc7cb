"""Counts in the controller's damping shake a slow joint: its windows are found and left out."""

import numpy as np
import pandas as pd
import pytest
from rigs.looped_joint import LoopedJoint

from bayesfric.recording.held import answering, held_for, position_held_for, released
from bayesfric.rigs import all_rigs
from bayesfric.rigs.single_axis import entering
from bayesfric.rigs.single_axis.dither import steady
from bayesfric.rigs.single_axis.even_log import EvenLog

pytestmark = pytest.mark.usefixtures("lengths_not_searched")
AXIS = all_rigs()["single-axis"]
SHAKEN = {"stiffness": 60.0, "damping": 12.0, "amplitude": 0.2}


@pytest.mark.parametrize("count", [pytest.param(1e-3, marks=pytest.mark.nightly), 2e-3])
def test_friction_of_a_joint_that_dithers_is_told_where_it_does_not(count):
    """With all windows Coulomb friction is 8 or 27 % too low, viscous friction 80 or 260 % off."""
    joint = LoopedJoint(count=count, **SHAKEN)
    runs = AXIS.trials(joint.recording())
    assert runs.dither.left_out
    assert 20 < runs.dither.windows < runs.dither.of
    rough = runs._rough
    assert rough.coulomb == pytest.approx(joint.coulomb, rel=0.02)
    assert rough.mass == pytest.approx(joint.inertia, rel=0.02)
    assert f"In {runs.dither.windows} of {runs.dither.of} windows the joint dithers" in " ".join(
        runs.doubts({})
    )


@pytest.mark.parametrize(
    "force_is", ["commanded", pytest.param("motor", marks=pytest.mark.nightly)]
)
def test_a_force_that_is_held_over_the_kicks_of_a_controller_is_told_by_the_counts(force_is):
    """With one force in five: inertia 0.09 to 0.26, Coulomb friction 0.03 to 0.59."""
    joint = LoopedJoint(count=1e-3, gravity=0.0, force_held=5, **SHAKEN)
    recording = joint.recording(force_is=force_is)
    runs = AXIS.trials(recording)
    assert runs.dither.left_out
    rough = runs._rough
    assert rough.mass == pytest.approx(joint.inertia, rel=0.02)
    assert rough.coulomb == pytest.approx(joint.coulomb, rel=0.02)
    assert rough.viscous == pytest.approx(joint.viscous, rel=0.1)
    first = recording.axis.samples.query("run == 'r0'")
    assert "the force follows each encoder count" in released(first, force_is)[1]


@pytest.mark.parametrize(("count", "shaken"), [(2 * np.pi / 2**16, True), (1e-8, False)])
def test_counts_show_in_a_log_of_every_fifth_command(count, shaken):
    """A loop of 500 Hz, logged at 100 Hz: four slow windows named cogging with 0.98."""
    time = np.arange(0, 20, 0.002)
    reference, inertia = 0.3 * np.sin(1.7 * time) + 0.2 * np.sin(4.1 * time), 0.02
    read = count * np.round(reference / count)
    moved, speed = np.diff(read, prepend=read[0]) / 0.002, np.gradient(reference, 0.002)
    force = inertia * np.gradient(speed, 0.002) + 7.0 * (speed - moved)
    every = slice(None, None, 5)
    everywhere = np.ones(time[every].size, dtype=bool)
    log = EvenLog(time[every], read[every], force[every], everywhere, 0.01, {})
    logs, dither = steady([log], inertia, 0.08, count)
    assert (dither.windows > 2) is shaken
    if shaken:
        slow = np.abs(speed[every]) < 0.05
        assert logs[0].dithers[slow].mean() > 4 * logs[0].dithers[~slow].mean()


@pytest.mark.nightly
def test_a_joint_of_which_too_little_would_be_left_enters_with_its_dither(monkeypatch):
    """A log of 2 s was refused: 5 of 11 windows shook, and wider ones left 2."""
    joint = LoopedJoint(count=2e-3, **SHAKEN)
    seen = []

    def few(readings):
        seen.append(readings)
        return "too few" if len(seen) == 1 else None

    monkeypatch.setattr(entering, "refused_for_few_windows", few)
    runs = AXIS.trials(joint.recording())
    assert len(seen) == 2
    assert runs.dither.windows > 20
    assert not runs.dither.left_out
    assert "too few would be left" in " ".join(runs.doubts({}))


def test_a_slow_controllers_command_acts_as_it_is_held():
    """Its speed is of its own interval, five samples of the log, and so are its kicks."""
    rng = np.random.default_rng(2)
    position = 1e-3 * np.round(np.cumsum(0.4e-3 * rng.standard_normal(4000)) / 1e-3)
    answer = -600.0 * (position - np.concatenate([np.zeros(5), position[:-5]]))
    held = answer[np.arange(4000) // 5 * 5] + 1e-3 * np.repeat(rng.standard_normal(800), 5)
    assert held_for(held) == 5
    assert answering(position, held) is None


@pytest.mark.nightly
def test_a_joint_that_is_fast_or_that_a_sensor_shakes_does_not_dither():
    fast = LoopedJoint(count=1e-3, damping=6.0, stiffness=60.0)
    noisy = LoopedJoint(noise=0.3, closed=False)
    for joint in (fast, noisy, LoopedJoint(count=1e-2, closed=False)):
        assert AXIS.trials(joint.recording(force_is="motor")).dither.windows == 0


def test_a_coarse_encoder_that_is_held_with_its_force_is_read_where_the_force_is():
    """Every third count says nothing of the two between: kicks at these were taken for none."""
    rng = np.random.default_rng(3)
    time = 0.002 * np.arange(6000)
    position = 5e-3 * np.round(np.sin(2 * np.pi * 0.4 * time) / 5e-3)
    force = -10.0 * np.diff(position, prepend=0.0) + 0.3 + 1e-3 * rng.standard_normal(6000)
    held = np.arange(6000) // 3 * 3
    samples = pd.DataFrame({"time_s": time, "position_m": position[held], "force_n": force[held]})
    rows, said = released(samples, "commanded")
    assert said == "each reading is held, position for 3 samples"
    assert len(rows) == 2000
    np.testing.assert_array_equal(rows["force_n"], force[::3])
    np.testing.assert_array_equal(rows["position_m"], position[::3])


def test_a_coarse_encoder_that_is_held_moves_in_step_beside_a_noisy_force():
    """Where its force is new in every row, only the rows of its moves show that it is held."""
    rng = np.random.default_rng(5)
    time = 0.002 * np.arange(6000)
    position = 4e-3 * np.round(0.6 * np.sin(2 * np.pi * 0.4 * time) / 4e-3)
    held = np.arange(6000) // 2 * 2
    force = np.sin(7 * time) + 0.3 * rng.standard_normal(6000)
    noisy = force[held] + 0.01 * rng.standard_normal(6000)
    samples = pd.DataFrame({"time_s": time, "position_m": position[held], "force_n": noisy})
    rows, said = released(samples, "motor")
    assert said == "each reading is held, position for 2 samples and force for 2 samples"
    np.testing.assert_array_equal(rows["position_m"], position[::2])
    np.testing.assert_allclose(rows["force_n"], noisy.reshape(-1, 2).mean(axis=1))
    assert position_held_for(position, noisy) == 1


def test_a_coarse_encoder_at_one_speed_moves_in_step_and_is_not_held():
    position = 1e-3 * (np.arange(1200) // 6)
    noise = np.random.default_rng(6).standard_normal(1200)
    assert position_held_for(position, noise) == 1


def test_a_position_that_moves_a_few_times_when_its_force_does_may_do_so_by_chance():
    force = np.repeat(np.random.default_rng(4).standard_normal(100), 2)
    position = np.where(np.arange(200) < 60, 0.0, np.where(np.arange(200) < 120, 1e-3, 2e-3))
    assert held_for(force) == 2
    assert position_held_for(position, force) == 1


def test_a_reading_that_equals_the_one_before_is_a_reading_too():
    """At a stop readings are alike: without them the rows beside it seemed to be late."""
    time = 0.002 * np.arange(6000)
    position = np.maximum(np.sin(2 * np.pi * 0.4 * time), -0.8)
    held = np.arange(6000) // 3 * 3
    force = np.cos(2 * np.pi * 0.4 * time)[held]
    samples = pd.DataFrame({"time_s": time, "position_m": position[held], "force_n": force})
    rows, said = released(samples, "commanded")
    assert said == "each reading is held, position for 3 samples"
    np.testing.assert_allclose(rows["time_s"], time[::3], atol=0.0021)
    np.testing.assert_allclose(np.diff(rows["time_s"]).max(), 0.006, atol=0.0021)

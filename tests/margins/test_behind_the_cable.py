"""Friction, play and encoder behind the cable, and a filtered position: by hand, from outside."""

from dataclasses import replace
from pathlib import Path

import control
import numpy as np
import pytest
from margins import two_masses
from margins.loops import shaft

from bayesfric.margins.certificate import not_applicable
from bayesfric.margins.describing import effective_damping, formula_conditions, steady_error
from bayesfric.margins.diagnosed import with_effects
from bayesfric.margins.linear import is_stable
from bayesfric.margins.loop_file import Loop
from bayesfric.margins.loop_reading import read_loop
from bayesfric.margins.metrics import closed_forms, linear_of
from bayesfric.margins.open_loop import OpenLoop
from bayesfric.margins.plant import plant_of
from bayesfric.margins.simulating import simulate
from bayesfric.margins.state_space import state_space
from bayesfric.margins.thresholds import find_hunting

ONE = np.ones(1)
ROW = np.zeros(1, dtype=np.intp)
COUNT = 2 * np.pi / 4000
CABLE_N = 2 * 5 * (0.0128 * 10 + 0.0261)
LONG = {"cable.length_m": 0.5}
AT_JOINT = {"controller.encoder_at": "joint", "controller.encoder_counts_per_revolution": 400_000}
PLAY = {"drive.backlash_rad": 0.1}


def figure(changes, name):
    """A closed form of one draw."""
    bench = shaft(changes)
    return float(closed_forms(bench, linear_of(bench))[name, None][0])


def test_friction_of_the_joint_by_hand():
    # 0.05 N·m over 100: 5e-4 N·m at the motor, 0.5 N of cable, behind 0.5 m at 2 × 15 kN
    own = {**LONG, "joint.friction_n_m": 0.05}
    bench, without = shaft(own), shaft(LONG)
    stiffness = 1e-6 * 2 * 15e3 / 0.5
    assert bench.friction - without.friction == pytest.approx(5e-4)
    assert bench.lost_motion - without.lost_motion == pytest.approx(5e-4 / stiffness)
    assert bench.cable_friction == pytest.approx(without.cable_friction)
    assert bench.cable_friction == pytest.approx(1e-3 * CABLE_N)
    assert without.side_tension[0] - bench.side_tension[0] == pytest.approx(0.5 / 2)
    assert steady_error(bench) == pytest.approx((0.003541 + 5e-4) / 0.02)
    assert figure(own, ("backdrive_force")) == pytest.approx((0.003541 + 5e-4) / 0.005)


def test_friction_of_a_prismatic_joint_by_hand():
    slide = {
        **{f"joint.{name}": None for name in ("inertia_kg_m2", "transmission_rad_per_rad")},
        "joint.kind": "prismatic",
        "joint.mass_kg": 0.5,
        "joint.transmission_rad_per_m": 1000.0,
        "joint.friction_n": 0.4,
        "tool": None,
    }
    assert shaft(slide).friction == pytest.approx(0.003541 + 0.4 / 1000)


def test_effects_of_a_diagnosis_leave_the_joint_s_own_friction_alone():
    """No effect acts: the law alone remains, and with it what motor and joint add."""
    bench = shaft({**LONG, "joint.friction_n_m": 0.05})
    given = type("Given", (), {"draws": 1, "acting": ()})()
    after = with_effects(bench, given)
    for name in ("friction", "lost_motion", "joint_friction"):
        assert getattr(after, name) == pytest.approx(getattr(bench, name)), name


def test_play_is_lost_motion_unless_the_load_holds_it():
    tip = 0.5 / 100
    base = figure({}, "lost_motion")
    assert figure(PLAY, "lost_motion") - base == pytest.approx(0.1 / 2 * tip)
    more = figure(PLAY, "reversal_error") - figure({}, "reversal_error")
    assert more == pytest.approx(2 * 0.1 / 2 * tip)
    # 1.541e-3 N·m of cable friction lie behind the play: 0.1541 N·m at the joint
    for load, held in ((0.15, False), (0.16, True)):
        loaded = {"joint.load_n_m": load}
        more = figure({**PLAY, **loaded}, "lost_motion") - figure(loaded, "lost_motion")
        assert more == pytest.approx(0.0 if held else 0.1 / 2 * tip)


def test_an_encoder_at_the_joint_sees_what_the_cable_does():
    loaded = {**LONG, **PLAY, "joint.load_n_m": 0.1}
    for name in ("lost_motion", "cable_stretch"):
        assert figure(loaded, name) > 0.0
        assert figure({**loaded, **AT_JOINT}, name) == 0.0
    alone = 2 * 0.003541 / 0.02 * 5e-3  # m at the tip
    assert figure({**LONG, **AT_JOINT}, "reversal_error") == pytest.approx(alone)
    assert shaft(AT_JOINT).counts == pytest.approx(4000)  # a turn of the motor


def test_a_scale_along_a_slide_is_refused():
    values = read_loop(Path("raven-insertion")).model_dump(exclude_none=True)
    values["controller"]["encoder_at"] = "joint"
    with pytest.raises(ValueError, match="prismatic"):
        Loop.model_validate(values)


def test_the_joint_s_response_is_that_of_the_far_inertia():
    bench = shaft({**LONG, **AT_JOINT, "joint.viscous_n_m_s": 0.5})
    opened = OpenLoop(bench)
    omega = np.array([1.0, 300.0, 4000.0])
    s = 1j * omega
    spring = bench.stiffness + s * bench.damping
    matrix = np.array([[2e-5 * s**2 + spring, -spring], [-spring, 1e-5 * s**2 + 5e-5 * s + spring]])
    far = np.linalg.inv(np.moveaxis(matrix, -1, 0))[:, 1, 0]
    assert opened(omega, ROW) == pytest.approx(opened.controller(omega, ROW) * far, rel=1e-9)


@pytest.mark.parametrize(
    "changes",
    [AT_JOINT, {"controller.position_cutoff_hz": 40.0}, {**AT_JOINT, "joint.friction_n_m": 0.05,
     "controller.position_cutoff_hz": 80.0, "controller.velocity_filter": "low-pass",
     "controller.velocity_cutoff_hz": 100.0, "controller.ki_n_m_per_rad_s": 0.02}],
)  # fmt: skip
def test_matrices_and_frequencies_are_one_loop(changes):
    opened = OpenLoop(shaft({**LONG, "controller.kd_n_m_s_per_rad": 4e-4, **changes}))
    omega = np.geomspace(1.0, 1000.0, 30)
    system = control.ss(*state_space(opened, 0))
    assert system(1j * omega) == pytest.approx(opened(omega, ROW), rel=1e-6)


def poles_are_stable(plant):
    """Whether the closed loop's poles all lie to the left, by python-control."""
    closed = control.feedback(control.ss(*state_space(OpenLoop(plant), 0)))
    return bool((closed.poles().real < 0).all())


@pytest.mark.parametrize(
    ("where", "stable"), [({}, [True] * 4), (AT_JOINT, [True, False, False, False])]
)
def test_a_loop_around_a_soft_cable_is_unstable_where_its_poles_say_so(where, stable):
    """The far end lags the torque: what the motor's encoder damps, the joint's may drive."""
    verdicts = []
    for length in (1e-3, 0.05, 0.2, 1.0):
        bench = shaft({"cable.length_m": length, **where})
        opened = OpenLoop(bench)
        verdicts.append(bool(is_stable(opened, opened.frequencies())[0]))
        assert poles_are_stable(bench) is verdicts[-1], length
    assert verdicts == stable


def test_a_filtered_position_delays_the_loop_by_its_time_constant():
    corner = 40.0
    bench = shaft({"controller.position_cutoff_hz": corner})
    lost = 0.02 / (2 * np.pi * corner)
    assert effective_damping(shaft()) - effective_damping(bench) == pytest.approx(lost)


@pytest.mark.parametrize(
    ("changes", "words", "why"),
    [
        ({"controller.position_cutoff_hz": 40.0}, "not filtered", "filtered"),
        (AT_JOINT, "at the motor", "at the joint"),
        (PLAY, "no play", "play"),
    ],
)
def test_formula_and_certificate_say_that_they_are_not_for_it(changes, words, why):
    inside, broken = formula_conditions(shaft(changes))
    assert not inside.any()
    assert any(words in reason for reason in broken)
    assert why in not_applicable(shaft({"compensation.boundary_rad_s": 2.0, **changes}))


def test_the_first_lines_name_encoder_and_play():
    sentence = plant_of(shaft({**AT_JOINT, **PLAY})).sentence
    assert "4000 counts a turn of it" in sentence
    assert "plays by 0.5 mm at the tip" in sentence  # 0.1 rad at 5 mm/rad
    assert "plays" not in plant_of(shaft()).sentence


SOFT = {**LONG, "controller.kp_n_m_per_rad": 0.004, "controller.kd_n_m_s_per_rad": 3e-4,
        "joint.viscous_n_m_s": 0.5, "joint.friction_n_m": 0.02}  # fmt: skip

WEAK = {"controller.kp_n_m_per_rad": 0.002, "controller.kd_n_m_s_per_rad": 0.0,
        "joint.viscous_n_m_s": 1.0}  # fmt: skip


def from_outside(bench, *, gamma=0.0, kick, speed=0.0, duration=3.0):
    """The measured end's errors in the last quarter, and the twist at the end."""
    plant = two_masses.elastic(bench, feed=gamma * float(bench.estimate[0]))
    _, motor, joint = two_masses.run(plant, kick=kick, speed=speed, duration=duration, steps=20)
    seen = joint if plant.at_joint else motor
    return seen[3 * seen.size // 4 :], joint[-1] - motor[-1]


@pytest.mark.parametrize(
    ("changes", "gamma", "speed", "swings"),
    [
        (AT_JOINT, 0.0, 0.0, False),
        ({**AT_JOINT, "joint.load_n_m": 0.1}, 0.0, 0.4, False),
        (PLAY, 0.0, 0.0, False),
        ({**PLAY, "joint.load_n_m": -0.1}, 0.0, 0.4, False),
        ({**PLAY, **AT_JOINT}, 0.0, 0.0, False),
        ({**PLAY, **AT_JOINT}, 2.0, 0.0, True),
        ({**PLAY, **WEAK}, 1.6, 0.0, True),
        ({"controller.position_cutoff_hz": 30.0}, 0.0, 0.0, False),
        ({"controller.position_cutoff_hz": 30.0, **WEAK}, 2.0, 0.0, True),
    ],
)
def test_the_simulator_moves_as_from_outside(changes, gamma, speed, swings):
    bench = shaft({**SOFT, **changes})
    kick = float(bench.kick[0])
    loop = bench.sampled(gamma * ONE)
    motion = simulate(loop, kick=kick, reference_speed=speed, duration=3.0, substeps=10)
    late, twist = from_outside(bench, gamma=gamma, kick=kick, speed=speed)
    assert bool(motion.hunts[0]) is swings
    if speed == 0.0:
        assert bool(np.ptp(late) > 4 * COUNT) is swings
    assert motion.amplitude[0] == pytest.approx(np.ptp(late) / 2, rel=0.05, abs=2 * COUNT)
    if not swings and speed == 0.0:
        assert motion.final_error[0] == pytest.approx(late[-1], abs=2 * COUNT)
        assert motion.twist[0] == pytest.approx(twist, abs=0.01)


def test_the_joint_rests_within_the_steady_error_of_its_own_encoder():
    bench = replace(shaft({**SOFT, **AT_JOINT}), gamma=np.zeros(1))
    band = float(steady_error(bench)[0])
    kicks = np.array([-3.0, -1.5, -0.7, 0.7, 1.5, 3.0]) * band
    loop = bench.taken(np.zeros(6, dtype=np.intp)).sampled()
    rests = np.abs(simulate(loop, kick=kicks, duration=4.0).final_error)
    assert rests.max() <= band + COUNT
    assert rests.max() > 0.6 * band


@pytest.mark.nightly
def test_play_that_no_one_asked_for_is_not_examined():
    speeds = {**SOFT, "kick.reference_range_rad_s": [0.5, 0.5]}
    assert "backlash" in find_hunting(shaft(speeds), 1, 0.05).not_examined
    assert "backlash" not in find_hunting(shaft({**speeds, **PLAY}), 1, 0.05).not_examined


def test_a_stiff_cable_with_play_is_still_two_masses():
    stiff = {"cable.axial_stiffness_n": 1e9}
    assert shaft(stiff).cable is None
    cable = shaft({**stiff, **PLAY}).cable
    assert cable.ringing * 1e-3 == pytest.approx(5.0)
    # all friction but the motor's is behind the play
    assert cable.rubs[-1] == pytest.approx(1.541e-3 / 3.541e-3)

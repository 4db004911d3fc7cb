"""Closed forms of friction in the loop, against figures by hand."""

from dataclasses import replace

import numpy as np
import pytest
from margins.loops import shaft
from margins.traced import traced

from bayesfric.margins.describing import (
    amplitude_margin,
    effective_damping,
    formula_conditions,
    formula_threshold,
    natural_frequency,
    necessary_gain,
    reversing_error,
    steady_error,
    swing_amplitude,
)
from bayesfric.margins.hunting import after_a_kick
from bayesfric.margins.metric_definitions import RULES
from bayesfric.margins.metrics import closed_forms, linear_of, missed_draws
from bayesfric.margins.scanning import REST, Condition, run
from bayesfric.margins.simulating import simulate
from bayesfric.report.chapters.specs import WORDS


def test_what_stands_at_the_shaft():
    # load 0.1/100² = 1e-5; cable force 2·5·(0.128 + 0.0261) N at 1 mm/rad
    bench = shaft({"joint.viscous_n_m_s": 0.01, "drive.viscous_n_m_s": 2e-6, "joint.load_n_m": 3.0})
    assert bench.inertia == pytest.approx(3e-5)
    assert bench.viscous == pytest.approx(1e-6 + 2e-6)
    assert bench.friction == pytest.approx(0.002 + 1e-3 * 1.541)
    assert bench.load_torque == pytest.approx(0.03)
    assert bench.lag == pytest.approx(1.5e-3)
    assert bench.tip_per_rad == pytest.approx(0.5 / 100)
    assert bench.stiffness == pytest.approx(1e-6 * 2 * 15e3 / 0.01)
    assert bench.clip == pytest.approx(0.1)
    assert bench.lost_motion == pytest.approx(1541e-3 / (2 * 2 * 15e3 / 0.01) / 1e-3)


@pytest.mark.parametrize(
    ("torque_at", "angle_of", "factor"),
    [
        ("motor", "motor", 1),
        ("gearbox-output", "motor", 10),
        ("gearbox-output", "gearbox-output", 100),
        ("joint", "joint", 100 * 100),
        ("joint", "motor", 100),
    ],
)
def test_gains_of_any_frame_come_to_the_shaft(torque_at, angle_of, factor):
    bench = shaft({"controller.torque_at": torque_at, "controller.angle_of": angle_of})
    assert bench.kp == pytest.approx(0.02 / factor)
    assert bench.kd == pytest.approx(1e-3 / factor)


@pytest.mark.parametrize(("force", "measured"), [(1.0, 1.42), (2.0, 2.84), (4.0, 5.68)])
def test_the_amplitude_that_friction_holds(force, measured):
    # Kp 0.05 over 26/7, J 3.4e-6, no damping, 1.5 ms in all: simulated 1.42, 2.84, 5.68 rad
    gear = 26 / 7
    bench = shaft({
        "controller.kp_n_m_per_rad": 0.05, "controller.torque_at": "gearbox-output",
        "controller.kd_n_m_s_per_rad": 0.0, "drive.gearbox_ratio": gear,
        "compensation.signal": "none",
    })  # fmt: skip
    bench = replace(bench, motor_inertia=np.array([3.4e-6]), load_inertia=np.zeros(1),
                  friction=np.array([force * 0.005005 / gear]))  # fmt: skip
    kp = 0.05 / gear
    by_hand = 4 * force * 0.005005 / gear / (np.pi * np.sqrt(kp / 3.4e-6) * kp * 1.5e-3)
    assert amplitude_margin(bench) == pytest.approx(by_hand, rel=1e-12)
    assert amplitude_margin(bench) == pytest.approx(measured, rel=0.1)


STIFF = {"cable.axial_stiffness_n": 1e9, "compensation.signal": "none"}


def test_an_integral_takes_from_the_damping_and_friction_holds_so_much_less():
    # unstable from ki = b kp/J on; at 1.2 of it b_eff is −0.2 b, and A is 4F/(0.2 π ω_n b)
    damping = 1e-3 - 0.02 * 1.5e-3
    bench = shaft({**STIFF, "controller.ki_n_m_per_rad_s": 1.2 * damping * 0.02 / 3e-5})
    held = amplitude_margin(bench)
    by_hand = 4 * 0.003541 / (np.pi * np.sqrt(0.02 / 3e-5) * 0.2 * damping)
    assert held == pytest.approx(by_hand, rel=1e-9)
    assert closed_forms(bench, linear_of(bench))["amplitude_margin", None] == pytest.approx(by_hand)
    tried = bench.taken(np.zeros(2, dtype=int)).sampled()
    motion = simulate(tried, kick=np.array([0.95, 1.15]) * held, duration=3.0)
    assert motion.hunts.tolist() == [False, True]


def test_a_compensator_of_the_error_is_a_spring_that_delay_makes_ring():
    # kp + 0.003/0.01 = 0.32, with a delay of 1.5 ms: 4.8e-4 against kd of 3.5e-4
    band = {"compensation.signal": "error", "compensation.boundary_rad": 0.01}
    bench = shaft({**STIFF, **band, "controller.kd_n_m_s_per_rad": 3.5e-4})
    by_hand = 4 * 0.003541 / (np.pi * np.sqrt(0.32 / 3e-5) * 1.3e-4)
    assert amplitude_margin(bench) == pytest.approx(by_hand, rel=1e-9)


@pytest.mark.parametrize(
    "changes",
    [  # so much kd that its delay makes it swing, and an integral in whose swings the joint slips
        {**STIFF, "controller.kd_n_m_s_per_rad": 2e-2, "controller.delay_s": 4e-3},
        {**STIFF, "controller.ki_n_m_per_rad_s": 1.4 * 9.7e-4 * 0.02 / 3e-5},
    ],
)  # fmt: skip
def test_an_amplitude_that_is_not_known_counts_as_missed(changes):
    bench = shaft({**changes, "spec.amplitude_margin_min_rad": 0.01})
    linear = linear_of(bench)
    assert not linear[None].stable.any()
    values = closed_forms(bench, linear)
    assert np.isnan(values["amplitude_margin", None]).all()
    assert missed_draws(bench, values)["amplitude_margin"].all()


def test_compensation_takes_from_what_holds():
    weak = {"controller.kd_n_m_s_per_rad": 0.0}
    alone = amplitude_margin(shaft({**weak, "compensation.signal": "none"}))
    half = amplitude_margin(shaft({**weak, "compensation.gain": 0.5}))
    assert half / alone == pytest.approx((3.541 - 1.5) / 3.541)
    assert np.isinf(amplitude_margin(shaft()))


@pytest.mark.parametrize(("ratio", "threshold"), [(0.11, 1.13), (0.42, 1.60), (0.84, 1.98)])
def test_the_threshold_grows_with_damping(ratio, threshold):
    # ω_n τ = 0.05: of the ratio, 0.025 goes to the delay
    kp = 3e-5 * (0.05 / 1.5e-3) ** 2
    bench = shaft({
        "controller.kp_n_m_per_rad": kp, "compensation.estimate_n_m": 0.003541,
        "controller.kd_n_m_s_per_rad": 2 * ratio * np.sqrt(kp * 3e-5),
    })  # fmt: skip
    assert effective_damping(bench) / (2 * np.sqrt(kp * 3e-5)) == pytest.approx(ratio - 0.025)
    assert formula_threshold(bench) == pytest.approx(threshold, abs=0.012)


@pytest.mark.parametrize(("counts", "applies"), [(12_000, True), (100_000, False)])
def test_the_threshold_is_where_the_simulator_begins_to_hunt(counts, applies):
    # ω_n τ = 0.05 and ζ = 0.6: 1 + tanh(π 0.6/1.6) = 1.827, where 1 + π 0.6/2 is 1.942
    kp = 3e-5 * (0.05 / 1.5e-3) ** 2
    bench = shaft({
        "controller.kp_n_m_per_rad": kp, "compensation.estimate_n_m": 0.003541,
        "controller.kd_n_m_s_per_rad": 2 * 0.625 * np.sqrt(kp * 3e-5),
        "controller.encoder_counts_per_revolution": counts,
    })  # fmt: skip
    threshold = formula_threshold(bench)
    assert threshold == pytest.approx(1.827, abs=1e-3)
    inside, broken = formula_conditions(bench)
    # a finer encoder sees the motor spring back on its cable, and hunting begins below 0.85 γ*
    assert inside.all() == applies
    assert applies or broken == ("F stretches the cable by at most 3 encoder counts",)
    shares = np.array([0.95, 1.05] if applies else [0.75, 0.89])
    tried = bench.taken(np.zeros(2, dtype=int))
    still = after_a_kick(tried.sampled(shares * threshold), tried.kick, np.zeros(2)).hunts
    assert still.tolist() == [False, True]


def test_at_the_threshold_the_swing_reaches_the_stuck_band():
    bench = shaft()
    bench = replace(bench, gamma=formula_threshold(bench))
    assert swing_amplitude(bench) == pytest.approx(bench.friction / bench.kp, rel=1e-12)
    assert np.isnan(swing_amplitude(replace(bench, gamma=np.array([1.0])))).all()
    assert natural_frequency(bench) == pytest.approx(np.sqrt(0.02 / 3e-5))


def test_below_the_gain_that_is_necessary_at_rest_a_creeping_loop_hunts():
    bench = shaft({"compensation.estimate_n_m": 0.003541})
    assert necessary_gain(bench) == pytest.approx(1.0)
    creeping = run(bench, (Condition(counts=0.2), REST), np.array([0.6]))
    assert creeping.hunts.tolist() == [True, False]
    note = next(rule.note for rule in RULES if rule.name == "gamma_necessary")
    assert "cannot hunt with the reference at rest" in note
    assert "creeps, it may hunt far below" in note
    assert WORDS["gamma_necessary"] == "γ necessary to hunt at rest"


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"compensation.at_rest": "hold"}, "off at rest"),
        ({"compensation.boundary_rad_s": 1.0}, "boundary"),
        ({"controller.ki_n_m_per_rad_s": 0.01}, "integral"),
        ({"stiction_ratio": 1.3}, "breakaway"),
        ({"kick.reference_speed_rad_s": 1.0}, "reference rests"),
        ({"controller.kd_n_m_s_per_rad": 0.0}, "damped"),
        ({"controller.delay_s": 0.01}, "ω_n τ"),
        ({"controller.kd_n_m_s_per_rad": 1.4e-3}, "ζ"),
        ({"controller.encoder_counts_per_revolution": 500}, "100 encoder counts"),
        ({"kick.over_stuck_band": 0.9}, "kick"),
        ({"drive.current_limit_a": 0.1}, "clipped"),
    ],
)
def test_outside_its_conditions_the_formula_says_so(changes, words):
    inside, broken = formula_conditions(shaft())
    assert inside.all(), broken
    inside, broken = formula_conditions(shaft(changes))
    assert not inside.any()
    assert any(words in reason for reason in broken)


def test_the_steady_error_of_each_compensator():
    alone = 0.003541 / 0.02
    assert steady_error(shaft()) == pytest.approx(alone)
    assert steady_error(shaft({"stiction_ratio": 1.5})) == pytest.approx(1.5 * alone)
    # inside its band a compensator of the error is a spring 0.003/0.2 beside kp
    band = {"compensation.signal": "error", "compensation.boundary_rad": 0.2}
    assert steady_error(shaft(band)) == pytest.approx(0.003541 / (0.02 + 0.003 / 0.2))
    band["compensation.boundary_rad"] = 0.01  # and beyond it a constant
    assert steady_error(shaft(band)) == pytest.approx((0.003541 - 0.003) / 0.02)


@pytest.mark.parametrize("signal", ["measured", "reference"])
def test_a_compensator_that_holds_its_sign_pushes_against_the_new_motion(signal):
    # γ F̂ = 0.5 × 0.003 beside F = 0.003541, over kp = 0.02; 5 mm a radian at the tip
    holds = {"compensation.signal": signal, "compensation.gain": 0.5}
    bench = shaft({**holds, "compensation.at_rest": "hold"})
    assert reversing_error(bench) == pytest.approx((0.003541 + 0.0015) / 0.02)
    values = closed_forms(bench, linear_of(bench))
    assert values["smallest_step", None] == pytest.approx(5e-3 * 0.005041 / 0.02)
    unseen = float(bench.unseen_motion[0])
    assert values["reversal_error", None] == pytest.approx(2 * 5e-3 * (0.005041 / 0.02 + unseen))
    assert values["steady_error_servo", None] == pytest.approx(5e-3 * 0.003541 / 0.02)
    off = shaft({**holds, "compensation.at_rest": "off"})
    assert reversing_error(off) == pytest.approx(0.003541 / 0.02)


def test_a_step_back_moves_a_joint_that_holds_its_sign_from_where_it_is_said():
    # arrived from the other side, it stands at the reference with the compensator's sign behind it
    bench = shaft({"compensation.gain": 0.5, "compensation.at_rest": "hold"})
    band = float(reversing_error(bench)[0])
    # with the kick, the error is ahead of the reference: from it the joint moves back, and its
    # sign turns; the first command still has the sign that its beginning left, none
    arrives = traced(bench.sampled(), kick=bench.kick, duration=1.0).traces
    stops = float(arrives.position[-1, 0])
    assert arrives.speed[-1, 0] == 0.0
    torque = float(arrives.torque[-1, 0])
    assert torque == pytest.approx(-0.02 * stops - 0.0015, rel=0.02)
    # a step by x forward adds kp x to that; it moves from the one that reaches F
    assert (0.003541 - torque) / 0.02 - stops == pytest.approx(band, rel=0.02)

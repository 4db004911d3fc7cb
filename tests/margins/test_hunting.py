"""Where a loop begins to hunt: published figures, describing functions, and what cannot hunt.

The loop of the figures is an arm joint's: kp 0.3 N·m/rad behind a gearbox of 12.25, J 2e-5 kg·m²
at the shaft (an RE40 rotor and what it drives), so ω_n = 35 rad/s; ζ is that of b_eff =
kd + b − kp τ, the delay of 1 ms and half a sample of hold included. The loop of the
friction-stabilised swing is a wrist's: kp 0.05 N·m/rad behind 26/7, no kd, viscous 1e-6 N·m·s/rad,
cable force on a capstan of 5.005 mm.
"""

from dataclasses import replace

import numpy as np
import pytest
from benchmark.kernels import timed

from bayesfric.margins.hunting import hunting_threshold, run_length
from bayesfric.margins.sampled_loop import SampledLoop
from bayesfric.margins.simulating import simulate

COUNT = 2 * np.pi / 4000


def arm_loop(zeta, counts, **changes):
    inertia, kp = 2e-5, 0.3 / 12.25
    zeta, friction = np.broadcast_arrays(zeta, np.asarray(counts) * COUNT * kp)
    usual = {
        "inertia": inertia,
        "viscous": 0.0,
        "friction": friction,
        "kp": kp,
        "kd": 2 * zeta * np.sqrt(kp * inertia) + kp * 1.5e-3,
        "sample_time": 1e-3,
        "delay": 1e-3,
        "counts_per_revolution": 4000,
        "compensation_signal": "measured",
        "compensation_estimate": friction,
    }
    return SampledLoop(**(usual | changes))


def test_threshold_against_damping():
    loop = arm_loop(np.array([0.11, 0.42, 0.84]), 130)
    threshold = hunting_threshold(loop, kick=2 * 130 * COUNT).gamma
    assert threshold == pytest.approx([1.20, 1.65, 2.20], rel=0.05)


def test_threshold_is_within_its_tolerance_of_where_hunting_begins():
    # Without steps of the encoder, which would leave narrow bands of γ that hunt below it.
    loop = arm_loop(np.array([0.2, 0.5]), 130, counts_per_revolution=0)
    kick = 2 * 130 * COUNT
    threshold = hunting_threshold(loop, kick=kick, tolerance=0.004).gamma
    for below, expected in ((0.0, True), (0.005, False)):
        tried = replace(loop, compensation_gain=threshold - below)
        hunts = simulate(tried, kick=kick, duration=run_length(loop).duration).hunts
        assert hunts.tolist() == [expected, expected]


def test_threshold_against_friction_in_counts():
    counts = np.array([130, 39, 18, 10, 5])
    threshold = hunting_threshold(arm_loop(0.42, counts), kick=2 * counts * COUNT).gamma
    assert threshold[:3] == pytest.approx([1.65, 1.90, 2.60], rel=0.05)
    assert np.isinf(threshold[3:]).all()


def test_threshold_does_not_depend_on_the_kick_above_breakaway_and_needs_one():
    friction = 130 * COUNT
    kick = np.array([0.95, 1.2, 3.0]) * friction
    threshold = hunting_threshold(arm_loop(0.42, np.full(3, 130)), kick=kick).gamma
    assert np.isinf(threshold[0])
    assert threshold[1] == pytest.approx(threshold[2], rel=0.02)


def loops_within_the_conditions(draws):
    """F/kp of 100 to 400 counts, ω_n τ < 0.13, kick above F/kp, F̂ wrong by up to a third."""
    rng = np.random.default_rng(11)
    inertia, natural = 10 ** rng.uniform(-5.5, -4.3, draws), rng.uniform(30, 65, draws)
    kp, delay, zeta = (
        inertia * natural**2,
        rng.uniform(0, 1.5e-3, draws),
        rng.uniform(0.08, 0.84, draws),
    )
    friction = 100 * 4 ** rng.uniform(0, 1, draws) * COUNT * kp
    ratio, kick = rng.uniform(0.75, 1.3, draws), rng.uniform(1.2, 4, draws) * friction / kp
    viscous = rng.uniform(0, 0.05, draws) * np.sqrt(kp * inertia)
    loop = SampledLoop(
        inertia=inertia,
        viscous=viscous,
        friction=friction,
        kp=kp,
        kd=2 * zeta * np.sqrt(kp * inertia) + kp * (delay + 0.5e-3) - viscous,
        sample_time=1e-3,
        delay=delay,
        counts_per_revolution=4000,
        compensation_signal="measured",
        compensation_estimate=friction / ratio,
    )
    return loop, zeta, ratio, kick


def share_in_agreement(loop, kick, gamma):
    """Share of draws that are still at 0.9 of a predicted threshold and hunt at 1.1 of it."""
    twice = loop.taken(np.tile(np.arange(loop.draws), 2))
    tried = replace(twice, compensation_gain=np.concatenate([0.9 * gamma, 1.1 * gamma]))
    hunts = simulate(tried, kick=np.tile(kick, 2), duration=3.0).hunts
    below, above = hunts.reshape(2, -1)
    return np.mean(~below & above)


def test_formula_and_simulator_agree_on_where_hunting_begins():
    loop, zeta, ratio, kick = loops_within_the_conditions(200)
    # One swing of the linear loop with Coulomb friction −(γF̂ − F): it repeats at an amplitude of
    # (γF̂ − F)/kp · coth(πζ/(2√(1 − ζ²))), which has to exceed F/kp to break away again.
    swing = ratio * (1 + np.tanh(np.pi * zeta / (2 * np.sqrt(1 - zeta**2))))
    assert share_in_agreement(loop, kick, swing) >= 0.95
    # Its small-ζ form γ* = (F/F̂)(1 + πζ/2) is good to 10 % up to ζ of 0.7.
    low = np.flatnonzero(zeta < 0.7)
    formula = (ratio * (1 + np.pi * zeta / 2))[low]
    assert share_in_agreement(loop.taken(low), kick[low], formula) >= 0.95


def test_amplitude_that_friction_stabilises():
    inertia, kp, viscous = 3.4e-6, 0.05 * 7 / 26, 1e-6
    friction = np.array([1.0, 2.0, 4.0]) * 5.005e-3 * 7 / 26
    natural, damping = np.sqrt(kp / inertia), viscous - kp * 1.5e-3
    critical = 4 * friction / (np.pi * natural * abs(damping))
    assert critical == pytest.approx([1.42, 2.84, 5.68], rel=0.01)
    ratios = np.array([0.9, 0.98, 1.02, 1.1])
    loop = SampledLoop(
        inertia=inertia,
        viscous=viscous,
        friction=np.repeat(friction, 4),
        kp=kp,
        kd=0.0,
        sample_time=1e-3,
        delay=1e-3,
        counts_per_revolution=4000,
    )
    motion = simulate(loop, kick=np.outer(critical, ratios).ravel(), duration=3.0)
    assert motion.hunts.reshape(3, 4).tolist() == [[False, False, True, True]] * 3
    swings = motion.frequency[motion.hunts]
    assert swings == pytest.approx(natural / (2 * np.pi), rel=0.01)

    # Below, it still swings after a while, but dies out.
    shorter = simulate(loop, kick=0.9 * np.repeat(critical, 4), duration=0.7)
    assert (shorter.frequency > 9).all()
    assert (shorter.amplitude > 0.4).all()
    assert not shorter.hunts.any()


@pytest.mark.parametrize("reference_speed", [0.0, 1.0, -5.0])
def test_compensation_by_the_reference_never_hunts_and_by_the_measurement_does(reference_speed):
    rng = np.random.default_rng(8)
    zeta, counts = rng.uniform(0.1, 0.8, 40), rng.uniform(100, 300, 40)
    gamma, kick = rng.uniform(2.4, 4, 40), 2 * counts * COUNT
    hunts = {
        (signal, at_rest): simulate(
            arm_loop(
                zeta, counts, compensation_signal=signal, compensation_gain=gamma, at_rest=at_rest
            ),
            kick=kick,
            duration=2.0,
            reference_speed=reference_speed,
        ).hunts
        for signal in ("reference", "measured")
        for at_rest in ("off", "hold")
    }
    assert not hunts["reference", "off"].any()
    assert not hunts["reference", "hold"].any()
    if reference_speed == 0.0:
        assert hunts["measured", "off"].all()


def test_loop_that_is_unstable_by_itself_needs_no_compensation_to_hunt():
    loop = arm_loop(0.42, np.array([130, 130]), kd=np.array([0.0, 5e-4]))
    threshold = hunting_threshold(loop, kick=60.0).gamma
    assert threshold[0] == 0.0
    assert threshold[1] > 1.0


def test_a_run_is_as_long_as_each_draw_needs():
    loop = arm_loop(np.array([0.2, 0.8]), 130)
    # 8 · 2J/b = 8/(ζ ω_n), or ten periods of 2π/35 s
    lengths = run_length(loop)
    assert lengths.duration == pytest.approx(10 * 2 * np.pi / 34.99, rel=1e-3)
    assert lengths.settling == pytest.approx(lengths.duration / 2)
    assert run_length(arm_loop(0.1, 130)).duration == pytest.approx(8 / (0.1 * 34.99), rel=1e-3)
    # a reference at 0.2 rad/s takes 1.02 s for F/kp
    assert run_length(loop, 0.2).duration == pytest.approx(12 * 130 * COUNT / 0.2, rel=1e-3)
    assert run_length(arm_loop(0.1, 130, kp=0.0, kd=0.0)).duration == 5.0


def test_a_run_holds_slow_cycles_of_integral_action_or_says_that_it_does_not():
    ki = np.array([0.5, 0.5, 0.01])
    loop = arm_loop(0.42, np.full(3, 130), ki=ki, stiction_ratio=np.array([1.0, 1.3, 1.3]),
                    compensation_signal="none")  # fmt: skip
    reset = 0.3 / 12.25 / ki
    lengths = run_length(loop)
    assert lengths.wanted[0] == pytest.approx(10 * 2 * np.pi / 34.99, rel=1e-3)  # no stiction
    assert lengths.wanted[1:] == pytest.approx(6 * 4 * reset[1:] * 1.3 / 0.3)
    assert lengths.duration == pytest.approx(np.minimum(lengths.wanted, 60.0))
    assert lengths.duration[2] < lengths.wanted[2]


def test_of_several_conditions_the_first_to_hunt_counts():
    loop = arm_loop(0.42, np.array([130, 130]))
    below, above = np.full(2, 0.95 * 130 * COUNT), np.array([2.0, 0.9]) * 130 * COUNT
    threshold = hunting_threshold(loop, kick=np.array([below, above]))
    assert threshold.gamma[0] == pytest.approx(1.65, rel=0.05)
    assert np.isinf(threshold.gamma[1])
    assert threshold.condition.tolist() == [1, -1]


def test_conditions_one_after_another_find_what_they_find_together():
    loop = arm_loop(0.42, np.array([130, 130, 130]))
    kicks = np.array([[2.0, 0.9, 2.0], [0.95, 2.0, 2.0]]) * 130 * COUNT
    together = hunting_threshold(loop, kick=kicks)
    first = hunting_threshold(loop, kick=kicks[0])
    # the last draw hunts in another condition long before
    bounds = np.array([np.inf, np.inf, 0.7])
    second = hunting_threshold(loop, kick=kicks[1], hunts_at=np.minimum(first.gamma, bounds))
    assert together.gamma == pytest.approx(np.full(3, 1.65), rel=0.05)
    assert np.minimum(first.gamma, second.gamma)[:2] == pytest.approx(together.gamma[:2], abs=0.02)
    assert np.isinf(second.gamma).tolist() == [True, False, True]


@pytest.mark.nightly
@pytest.mark.parametrize("expected", [1, 2, 30])
def test_where_hunting_is_expected_changes_what_is_tried_and_not_what_is_found(expected):
    loop = arm_loop(np.array([0.1, 0.42, 0.9]), np.full(3, 130))
    kick = 2 * 130 * COUNT
    usual = hunting_threshold(loop, kick=kick)
    other = hunting_threshold(loop, kick=kick, expected=expected)
    assert np.array_equal(usual.gamma, other.gamma)
    assert np.array_equal(usual.condition, other.condition)


@pytest.mark.bench
def test_two_hundred_draws_take_a_second_of_motion_in_less_than_three(benchmark):
    loop = arm_loop(np.full(200, 0.42), 130, compensation_gain=2.0)
    name = "a second of motion of 200 loops"
    timed(benchmark, name, lambda: simulate(loop, kick=0.5, duration=1.0), within_s=3.0)

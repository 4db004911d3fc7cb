"""A shaft that stands is taken to its breakaway in closed form: as if sample by sample."""

import numpy as np
import pytest
from margins.test_sampled_loop import a_loop, random_loop
from margins.traced import traced

from bayesfric.margins.simulating import simulate


@pytest.mark.parametrize("at_rest", ["off", "hold"])
@pytest.mark.parametrize("signal", ["none", "reference", "measured", "error"])
def test_waiting_in_closed_form_changes_nothing(signal, at_rest):
    rng = np.random.default_rng(4)
    draws = 60
    loop = random_loop(
        rng,
        draws,
        compensation_signal=signal,
        at_rest=at_rest,
        boundary=rng.choice([0.5, 2.0] if signal == "error" else [0.0, 2.0], draws),
        kd=rng.uniform(6e-4, 1e-3, draws),  # damped, so that rounding does not grow
        ki=rng.choice([0.0, 0.05, 0.3], draws),
        load_torque=rng.uniform(-2e-3, 2e-3, draws),
        velocity_cutoff=rng.choice([300.0, np.inf], draws),
        torque_limit=0.02,
    )
    kick, speed = rng.uniform(-1, 1, draws), rng.choice([0.0, -0.05, 0.1, 1.0], draws)
    arguments = {"kick": kick, "duration": 1.0, "reference_speed": speed}
    one_by_one = traced(loop, **arguments)  # traces have every sample
    at_once = simulate(loop, **arguments)
    assert at_once.hunts.tolist() == one_by_one.hunts.tolist()
    for name in ("amplitude", "frequency", "final_error", "rms_error"):
        ours, theirs = getattr(at_once, name), getattr(one_by_one, name)
        assert ours == pytest.approx(theirs, rel=1e-6, abs=1e-9), name


def test_a_shaft_dragged_by_a_slow_reference_stays_until_the_error_reaches_breakaway():
    # stiction 1.5, kicked ahead by 0.1: the error goes evenly from −0.1 to 1.5 F/kp
    loop = a_loop(stiction_ratio=1.5, kd=0.0, delay=0.0)
    speed, until = 1e-3, (0.1 + 1.5 * 0.005 / (0.3 / 12.25)) / 1e-3
    before, after = (
        simulate(loop, kick=0.1, duration=share * until, reference_speed=speed)
        for share in (0.999, 1.001)
    )
    assert speed * 0.999 * until - before.final_error[0] == pytest.approx(0.1, abs=1e-5)
    # what breakaway has over friction is twice made good
    slipped = speed * 1.001 * until - after.final_error[0] - 0.1
    assert slipped == pytest.approx(2 * 0.5 * 0.005 / (0.3 / 12.25), rel=0.05)


def test_the_load_shifts_where_a_loop_comes_to_rest():
    # without friction, at rest kp e = load
    load = np.array([-2e-3, 0.0, 1e-3])
    motion = simulate(a_loop(friction=0.0, viscous=1e-5, load_torque=load), kick=0.0, duration=3.0)
    assert motion.final_error == pytest.approx(load * 12.25 / 0.3, abs=1e-6)


def test_the_derivative_lags_by_its_low_pass():
    # a shaft under a constant load of −1 speeds up by 1 rad/s², whatever this kd does to it
    loop = a_loop(kp=0.0, kd=1e-6, friction=0.0, delay=0.0, velocity_cutoff=200.0, inertia=1.0,
                  load_torque=-1.0)  # fmt: skip
    torque = traced(loop, kick=0.0, duration=0.2).traces.torque[-1, 0]
    share = 1 - np.exp(-0.2)
    late = 0.5e-3 + (1 - share) / share * 1e-3  # of the difference, and of the low-pass
    assert torque / -1e-6 == pytest.approx(0.199 - late, rel=1e-4)


def test_a_shaft_judged_early_is_judged_alike():
    # sliding, slipping in few counts and in many, swinging: by reference speed and gain
    speed, gain = (grid.ravel() for grid in np.meshgrid([0.3, 1.0, 8.0], [0.0, 0.3, 1.0, 3.0]))
    loop = a_loop(
        kd=9e-4,
        viscous=1e-5,
        counts_per_revolution=4000,
        compensation_signal="measured",
        compensation_gain=gain,
        compensation_estimate=0.005,
    )
    arguments = {"kick": 0.4, "duration": 8.0, "reference_speed": speed}
    early, late = (
        simulate(loop, settling=settling_time, **arguments) for settling_time in (1.0, np.inf)
    )
    assert early.hunts.tolist() == late.hunts.tolist()
    assert 0 < late.hunts.sum() < late.hunts.size
    swings = late.hunts
    assert early.amplitude[swings] == pytest.approx(late.amplitude[swings], rel=0.1)
    assert early.frequency[swings] == pytest.approx(late.frequency[swings], rel=0.1)

"""The sampled loop in time, against closed forms, energy and an independent integrator."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from margins.traced import traced
from scipy.integrate import quad

from bayesfric.margins.sampled_loop import SampledLoop
from bayesfric.margins.simulating import simulate

INERTIA, KP = 2e-5, 0.3 / 12.25  # ω_n = 35 rad/s


def a_loop(**changes):
    usual = {
        "inertia": INERTIA,
        "viscous": 0.0,
        "friction": 0.005,
        "kp": KP,
        "kd": 6e-4,
        "sample_time": 1e-3,
        "delay": 1e-3,
    }
    return SampledLoop(**(usual | changes))


def random_loop(rng, draws, **changes):
    """Loops of every kind at once, stable or not."""
    usual = {
        "inertia": 10 ** rng.uniform(-5.5, -4.5, draws),
        "viscous": rng.uniform(0, 1e-4, draws),
        "friction": rng.uniform(1e-3, 6e-3, draws),
        "stiction_ratio": rng.uniform(1, 2, draws),
        "kp": rng.uniform(0.005, 0.05, draws),
        "kd": rng.uniform(0, 1e-3, draws),
        "ki": rng.uniform(0, 0.5, draws),
        "sample_time": 1e-3,
        "delay": rng.uniform(0, 3e-3, draws),
        "counts_per_revolution": rng.choice([0, 400, 4000], draws),
        "torque_limit": rng.uniform(0.005, 0.02, draws),
        "compensation_signal": "measured",
        "compensation_gain": rng.uniform(0, 2, draws),
        "compensation_estimate": 0.003,
        "boundary": rng.choice([0.0, 2.0], draws),
    }
    return SampledLoop(**(usual | changes))


# --- friction that falls with speed -----------------------------------------------------


def test_a_shaft_that_coasts_against_falling_friction_stops_where_it_must():
    # J v dv/dx = −(F + G e^(−v/vs)): travel ∫ J v/(F + G e^(−v/vs)) dv, by quadrature
    speed, more, own = np.array([2.0, 20.0, 60.0]), 0.004, 8.0
    loop = a_loop(kp=0, kd=0, falling=np.full(3, more), falling_speed=own)
    motion = traced(loop, kick=0.0, duration=0.5, reference_speed=speed, substeps=20)
    for place, first in enumerate(speed):
        travel, _ = quad(lambda v: INERTIA * v / (0.005 + more * np.exp(-v / own)), 0, first)
        assert motion.traces.position[-1, place] == pytest.approx(travel, rel=5e-3)


def test_falling_friction_holds_what_it_has_at_rest_and_no_more():
    # a torque between F and F + G leaves a shaft at rest where it is, one above moves it
    loop = a_loop(kd=0, falling=np.full(2, 0.004), falling_speed=1.0)
    motion = simulate(loop, kick=np.array([0.0089, 0.0091]) / KP, duration=0.05)
    assert motion.final_error[0] == pytest.approx(-0.0089 / KP)
    assert abs(motion.final_error[1]) < 0.9 * 0.0091 / KP


# --- energy -------------------------------------------------------------------------------


@pytest.mark.parametrize("viscous", [0.0, 1e-9, 3e-5, 1e-3])
def test_without_control_energy_only_falls_and_the_shaft_stops_where_it_must(viscous):
    speed = np.array([-40.0, -1.0, 0.3, 5.0, 90.0])
    loop = a_loop(kp=0, kd=0, viscous=viscous, friction=np.full(5, 0.004))
    motion = traced(loop, kick=0.0, duration=0.6, reference_speed=speed)
    energy = 0.5 * INERTIA * motion.traces.speed**2
    assert (np.diff(energy, axis=0) <= 0).all()
    assert (motion.traces.speed[-1] == 0).all()
    # J v dv/dx = −F − b v, integrated from the first speed to none.
    v, f = np.abs(speed), 0.004
    if viscous < 1e-6:
        travel = INERTIA * v**2 / (2 * f) * (1 - 2 * viscous * v / (3 * f))
    else:
        travel = INERTIA / viscous * (v - f / viscous * np.log1p(viscous * v / f))
    assert motion.traces.position[-1] == pytest.approx(np.sign(speed) * travel, rel=1e-9)


def test_friction_takes_at_least_its_torque_times_the_travel_whatever_the_controller_does():
    rng = np.random.default_rng(3)
    loop = random_loop(rng, 100)
    traces = traced(loop, kick=rng.uniform(-2, 2, 100), duration=0.4, reference_speed=1.0).traces
    kinetic = 0.5 * loop.inertia * traces.speed**2
    travel = np.diff(traces.position, axis=0)
    lost = traces.torque * travel - np.diff(kinetic, axis=0)  # the torque is constant in each
    rounding = 1e-13 * kinetic.max(axis=0)
    assert (lost >= loop.friction * np.abs(travel) - rounding).all()
    assert (lost > 100 * rounding).any(axis=0).all()


def test_without_friction_energy_is_that_of_the_torque():
    loop = a_loop(friction=0.0, kp=np.array([KP, 2 * KP]))
    traces = traced(loop, kick=1.0, duration=0.3).traces
    work = (traces.torque * np.diff(traces.position, axis=0)).sum(axis=0)
    assert work == pytest.approx(0.5 * INERTIA * traces.speed[-1] ** 2, rel=1e-10)


# --- rest ---------------------------------------------------------------------------------


@pytest.mark.parametrize("ratio", [1.0, 1.4])
def test_nothing_moves_below_breakaway_and_everything_above(ratio):
    share = np.array([-0.999, -0.5, 0.2, 0.999, 1.001, -1.001])
    kick = share * ratio * 0.005 / KP
    motion = traced(a_loop(stiction_ratio=np.full(6, ratio)), kick=kick, duration=0.3)
    still = np.abs(share) < 1
    assert (motion.traces.position[:, still] == kick[still]).all()
    assert (motion.final_error[still] == -kick[still]).all()
    assert (np.abs(motion.final_error[~still]) < np.abs(kick[~still])).all()
    assert not motion.hunts.any()


def test_a_held_compensation_still_pushes_at_rest_and_one_that_is_off_does_not():
    for at_rest, share in (("off", 0.0), ("hold", -1.0)):
        loop = a_loop(
            compensation_signal="measured",
            compensation_gain=0.6,
            compensation_estimate=0.005,
            at_rest=at_rest,
        )
        motion = traced(loop, kick=0.5, duration=0.5)
        assert motion.traces.speed[-50:] == pytest.approx(0.0, abs=0.0)
        pushed = -KP * motion.traces.position[-1, 0] + share * 0.6 * 0.005
        assert motion.traces.torque[-1, 0] == pytest.approx(pushed, rel=1e-12)


# --- the sampled controller ---------------------------------------------------------------


def test_torque_arrives_after_the_delay_whatever_its_ratio_to_the_sample_time():
    delay = np.array([0.0, 0.4e-3, 1e-3, 2.35e-3])
    loop = a_loop(friction=0.0, kd=0.0, delay=delay)
    traces = traced(loop, kick=0.2, duration=5e-3, substeps=7).traces
    until = delay + 1e-3  # in the first sample all torque is that of the kick
    pushed = np.clip(traces.time, delay, None) - delay
    expected = 0.2 - 0.2 * KP * pushed**2 / (2 * INERTIA)
    seen = traces.time <= until + 1e-12
    assert seen.any(axis=0).all()
    assert traces.position[seen] == pytest.approx(expected[seen], rel=1e-12)


def test_command_uses_the_stepped_reading_and_its_first_difference():
    step = 2 * np.pi / 400
    loop = a_loop(friction=0.0, delay=0.0, counts_per_revolution=400, torque_limit=0.3)
    traces = traced(loop, kick=0.26, duration=0.05).traces
    reading = np.rint(traces.position[:-1, 0] / step) * step
    speed = np.diff(reading, prepend=reading[0]) / 1e-3
    assert traces.torque[:, 0] == pytest.approx(-KP * reading - 6e-4 * speed, abs=1e-15)
    assert np.unique(speed).size > 2


def test_first_command_finds_the_shaft_moving_with_the_reference():
    motion = traced(a_loop(delay=0.0), kick=0.1, duration=1e-3, reference_speed=3.0)
    assert motion.traces.torque[0] == pytest.approx(-KP * 0.1, rel=1e-12)


def test_torque_is_clipped():
    loop = a_loop(torque_limit=0.012, viscous=1e-5)
    traces = traced(loop, kick=3.0, duration=0.5).traces
    assert np.abs(traces.torque).max() == 0.012
    with_more = traced(replace(loop, torque_limit=1.0), kick=3.0, duration=0.5)
    assert np.abs(with_more.traces.torque).max() > 0.05


def test_band_of_the_error_signal_adds_its_slope_to_the_stiffness():
    gain, band = np.array([0.0, 0.5, 1.5]), 0.4
    stiffness = KP + gain * 0.005 / band
    lag = 1.5e-3
    loop = a_loop(
        friction=0.0,
        kd=stiffness * lag,  # so that the linear loop neither grows nor decays
        compensation_signal="error",
        compensation_gain=gain,
        compensation_estimate=0.005,
        boundary=band,
    )
    motion = simulate(loop, kick=0.3, duration=4.0)
    natural = np.sqrt(stiffness / INERTIA) / (2 * np.pi)
    assert motion.frequency == pytest.approx(natural, rel=0.02)


def test_integral_action_with_stiction_hunts_and_without_does_not():
    # Armstrong and Amin 1996: no limit cycle of PID where breakaway is Coulomb friction.
    loop = a_loop(friction=0.004, kd=9e-4, ki=0.5, stiction_ratio=np.array([1.0, 1.2, 1.5, 2.0]))
    motion = simulate(loop, kick=0.3, duration=10.0)
    assert motion.hunts.tolist() == [False, True, True, True]
    # A slip over-shoots by what breakaway has over friction, so the amplitude is as 1 : 2.5 : 5.
    assert motion.amplitude[1:] / motion.amplitude[1] == pytest.approx([1, 2.5, 5], rel=0.05)


# --- numerics -----------------------------------------------------------------------------


def euler(loop, kick, reference_speed, duration, step):
    """Positions at the samples by small steps of semi-implicit Euler, one draw, continuous encoder.

    Friction takes speed off until none is left.
    """
    numbers = {name: value for name, value in vars(loop).items() if isinstance(value, np.ndarray)}
    loop = SimpleNamespace(**{name: value.item() for name, value in numbers.items()})
    n, late = round(1e-3 / step), round(loop.delay / step)
    x, v, seen, integral = kick, reference_speed, kick - reference_speed * 1e-3, 0.0
    waiting, torque, positions = [], 0.0, []
    for i in range(round(duration / step)):
        if i % n == 0:
            positions.append(x)
            speed, seen = (x - seen) / 1e-3, x
            error = reference_speed * i * step - x
            command = loop.kp * error + loop.kd * (reference_speed - speed)
            command += loop.ki * (integral + error * 1e-3)
            command += loop.compensation_gain * loop.compensation_estimate * np.sign(speed)
            clipped = min(max(command, -loop.torque_limit), loop.torque_limit)
            if clipped == command or command * error <= 0:
                integral += error * 1e-3
            waiting.append((i + late, clipped))
        while waiting and waiting[0][0] <= i:
            torque = waiting.pop(0)[1]
        if v != 0 or abs(torque) > loop.friction * loop.stiction_ratio:
            free = v + step * (torque - loop.viscous * v) / loop.inertia
            lost = step * loop.friction / loop.inertia
            after = float(np.sign(free)) * max(abs(free) - lost, 0.0)
            v = 0.0 if after * v < 0 else after  # no way past zero but by breaking away
        x += step * v
    return np.array(positions)


@pytest.mark.parametrize(
    ("signal", "reference_speed"), [("measured", 0.0), ("measured", 3.0), ("none", -2.0)]
)
def test_an_independent_integrator_converges_to_the_closed_form(signal, reference_speed):
    loop = a_loop(
        viscous=2e-5,
        ki=0.2,
        delay=1.6e-3,
        stiction_ratio=1.3,
        torque_limit=0.02,
        compensation_signal=signal,
        compensation_gain=1.2 if signal == "measured" else 0.0,
        compensation_estimate=0.004,
    )
    ours = traced(loop, kick=1.2, duration=0.15, reference_speed=reference_speed)
    at_samples = ours.traces.position[:-1:2, 0]  # two intervals a sample, as the delay is none
    errors = [
        np.abs(euler(loop, 1.2, reference_speed, 0.15, step) - at_samples).max()
        for step in (4e-5, 2e-5, 1e-5)
    ]
    assert errors[0] < 0.01
    # First order: half the step, half the error, as long as no stop falls beside a sample.
    assert errors[0] / errors[1] == pytest.approx(2, rel=0.15)
    assert errors[1] / errors[2] == pytest.approx(2, rel=0.15)


def test_smaller_steps_change_nothing():
    rng = np.random.default_rng(5)
    loop = random_loop(rng, 60, counts_per_revolution=0.0, kp=0.02, kd=5e-4, ki=0.0)
    whole, halves, eighths = (
        traced(loop, kick=1.0, duration=0.5, substeps=n).traces.position[::n] for n in (1, 2, 8)
    )
    assert np.abs(halves - whole).max() < 1e-9
    assert np.abs(eighths - whole).max() < 1e-9


def test_a_draw_does_not_depend_on_the_others():
    rng = np.random.default_rng(6)
    times = rng.choice([0.5e-3, 1e-3, 1.3e-3], 12)
    loop, kick = random_loop(rng, 12, sample_time=times), rng.uniform(0.2, 1, 12)
    together = simulate(loop, kick=kick, duration=0.4)
    for i in range(12):
        alone = simulate(loop.taken(np.array([i])), kick=kick[i], duration=0.4)
        for name in ("hunts", "amplitude", "frequency", "final_error"):
            assert getattr(alone, name)[0] == getattr(together, name)[i], name

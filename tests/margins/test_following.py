"""References that move, against closed forms."""

from dataclasses import replace

import numpy as np
import pytest
from margins.loops import loop, posterior, shaft, write_draws
from margins.traced import traced
from scipy import signal
from typer.testing import CliRunner

from bayesfric.cli import app
from bayesfric.errors import InputError
from bayesfric.margins import compute_margins
from bayesfric.margins.assembly import draw_assembly
from bayesfric.margins.following import follow_all, observers, strokes, with_compensator
from bayesfric.margins.observers import DisturbanceObserver, LuGreObserver
from bayesfric.margins.posterior import RigDiscrepancy
from bayesfric.margins.reference import ConstantSpeed, Stroke
from bayesfric.margins.reflecting import at_shaft
from bayesfric.margins.sampled_loop import SampledLoop
from bayesfric.margins.simulating import follow

MOVES = {"kick.reference_range_rad_s": None}
SOFT = {"cable.length_m": 1.0, "cable.damping_ratio": 0.3}
STIFF = {"cable.length_m": 1e-4}
T, J, B, KP = 1e-3, 2e-5, 1e-3, 0.0245


def a_loop(**changes):
    usual = {"inertia": J, "viscous": B, "friction": 0.0, "kp": KP, "kd": 0.0, "sample_time": T}
    return SampledLoop(**(usual | changes))


def stroke(begin=0.0, step=0.0, ramp=0.0, turn=np.inf, amplitude=0.0, omega=0.0):
    return Stroke(*(np.array([value]) for value in (begin, step, ramp, turn, amplitude, omega)))


# --- the reference ----------------------------------------------------------------------


def test_a_stroke_is_where_its_words_say():
    path = stroke(begin=1.0, step=0.3, ramp=2.0, turn=1.5)
    at = {0.5: (0.0, 0.0), 1.5: (1.3, 2.0), 2.5: (3.3, -2.0), 3.5: (1.3, -2.0)}
    for time, (position, speed) in at.items():
        assert path.position(np.array([time])) == pytest.approx(position)
        assert path.speed(np.array([time])) == pytest.approx(speed)
    wave = stroke(begin=1.0, amplitude=0.5, omega=np.pi)
    assert wave.position(np.array([1.5])) == pytest.approx(0.5)
    assert wave.speed(np.array([2.0])) == pytest.approx(-0.5 * np.pi)


@pytest.mark.parametrize("compensator", ["none", "reference", "measured", "error"])
def test_a_ramp_from_the_first_sample_on_is_the_constant_speed(compensator):
    servo = a_loop(friction=2e-3, kd=5e-4, delay=1.3e-3, counts_per_revolution=400, ki=0.1,
                 compensation_signal=compensator, compensation_gain=0.8,
                 compensation_estimate=2e-3, boundary=0.1)  # fmt: skip
    moving = follow(servo, ConstantSpeed(np.array([3.0])), 0.4)
    np.testing.assert_array_equal(moving, follow(servo, stroke(ramp=3.0), 0.4))
    traces = traced(servo, kick=0.0, duration=0.4, reference_speed=3.0).traces
    last = 3.0 * traces.time[-1] - traces.position[-1]
    assert moving[-1] == pytest.approx(last, abs=1e-12)


# --- loops without friction -------------------------------------------------------------


def test_a_ramp_is_followed_by_the_velocity_error():
    # kp e = b v, whatever kd and the delay
    servo = a_loop(kd=np.array([0.0, 4e-4]), delay=1e-3)
    path = Stroke(*np.array([[0.1, 0.1], [0, 0], [2.0, 5.0], [np.inf] * 2, [0, 0], [0, 0]]))
    assert follow(servo, path, 2.0)[-1] == pytest.approx(B * np.array([2.0, 5.0]) / KP, rel=1e-6)


def test_a_joint_on_its_cable_is_behind_by_its_own_drag_too():
    # of the viscous friction, the joint's part winds the cable up
    drag = {"joint.viscous_n_m_s": 5.0, "drive.friction_n_m": 0.0, "runs.0.tension_n": 1e-9}
    bench = shaft(MOVES | SOFT | drag | {"controller.encoder_counts_per_revolution": 1e9})
    bench = replace(bench, friction=0 * bench.friction + 1e-12)
    assert bench.cable is not None
    speed = 4.0
    error = follow(with_compensator(bench, "none"), stroke(begin=0.1, ramp=speed), 3.0)[-1]
    wanted = bench.viscous * speed / bench.kp + bench.load_viscous * speed / bench.stiffness
    assert bench.load_viscous[0] / bench.stiffness[0] > 0.2 * bench.viscous[0] / bench.kp[0]
    assert error == pytest.approx(wanted, rel=1e-3)


@pytest.mark.parametrize(("hertz", "kd"), [(1.0, 0.0), (4.0, 0.0), (9.0, 0.0), (4.0, 4e-4)])
def test_a_sine_is_followed_by_the_sensitivity(hertz, kd):
    # the plant by its own hold, one sample late, and the first difference, as SciPy has them
    omega, amplitude = 2 * np.pi * hertz, 0.7
    servo = a_loop(kd=kd, delay=T)
    error = follow(servo, stroke(amplitude=amplitude, omega=omega), 4.0 / min(hertz, 4.0) + 2.0)
    last = error[-round(2 / hertz / T) :, 0]
    time = np.arange(last.size) * T
    amplitude_of_error = 2 * abs(np.mean(last * np.exp(-1j * omega * time)))
    num, den, _ = signal.cont2discrete(([1.0], [J, B, 0.0]), T)
    z = np.exp(1j * omega * T)
    plant = np.polyval(num.ravel(), z) / np.polyval(den, z) / z
    sensitivity = 1 / (1 + plant * (KP + kd * (1 - 1 / z) / T))
    # S itself where the derivative has the reference's as well: within 3 %
    assert amplitude_of_error / amplitude == pytest.approx(
        abs(sensitivity), rel=1e-3 if kd == 0 else 0.03
    )
    exact = 1 - plant * (KP + kd * 1j * omega) * sensitivity
    assert amplitude_of_error / amplitude == pytest.approx(abs(exact), rel=1e-3)


# --- friction ---------------------------------------------------------------------------


def test_a_reversal_loses_twice_the_stuck_band():
    # P alone: the shaft stands while the reference goes from F/kp ahead to F/kp behind
    friction, speed = 4e-3, 0.2
    servo = a_loop(friction=friction)
    path = stroke(ramp=speed, turn=3.0)
    error = follow(servo, path, 8.0)[:, 0]
    time = np.arange(error.size) * T
    where = np.array([path.position(np.array([t]))[0] for t in time])
    shaft_at = where - error
    begins = np.flatnonzero(np.diff(shaft_at) < -1e-9)[0]
    drag = B * speed / KP  # what viscous friction adds to the error, 2.5 % here
    lost = where[3000] - where[begins]
    assert lost == pytest.approx(2 * friction / KP, rel=0.02)
    assert error[2999] - error[-1] == pytest.approx(2 * (friction / KP + drag), rel=0.01)


def test_a_compensator_of_the_reference_takes_friction_off_the_ramp():
    # (F − γF̂)/kp is left
    friction = np.array([3e-3, 4e-3])
    servo = a_loop(friction=friction, compensation_signal="reference", compensation_gain=0.5,
                 compensation_estimate=4e-3)  # fmt: skip
    path = Stroke(*np.array([[0.1] * 2, [0] * 2, [2.0] * 2, [np.inf] * 2, [0] * 2, [0] * 2]))
    assert follow(servo, path, 3.0)[-1] == pytest.approx((friction - 2e-3 + B * 2.0) / KP, rel=1e-6)


# --- observers --------------------------------------------------------------------------


def test_the_lugre_observer_builds_up_over_its_stretch_and_turns_round_over_twice_that():
    """At constant speed z = 1 − exp(−x/ε), and from there back z = −1 + (1 + z₀) exp(−x/ε)."""
    full, stretch, speed = np.array([3e-3]), np.array([0.05]), np.array([2.0])
    observer = LuGreObserver(full, stretch, np.array([T]))
    there = [observer.torque(speed, full)[0] for _ in range(100)]
    way = speed * T * np.arange(1, 101)
    assert there == pytest.approx(full * -np.expm1(-way / stretch))
    back = [observer.torque(-speed, full)[0] for _ in range(100)]
    first = there[-1] / full
    assert back == pytest.approx(full * (-1 + (1 + first) * np.exp(-way / stretch)))
    assert observer.torque(0 * speed, full) == pytest.approx(back[-1])  # bristles keep their bend


def test_the_disturbance_observer_finds_a_torque_as_its_low_pass_does():
    """A shaft under τ − d: J dω/dt + b ω = τ − d, and the estimate is d (1 − exp(−gt))."""
    step, torque, met, cutoff = 1e-5, 5e-3, 2e-3, 80.0
    observer = DisturbanceObserver(*(np.array([parameter]) for parameter in (J, B, cutoff, step)))
    time = step * np.arange(1, 4001)
    speed = (torque - met) / B * -np.expm1(-time * B / J)
    torques = [observer.torque(np.array([sample]), np.array([torque]))[0] for sample in speed]
    assert torques == pytest.approx(met * -np.expm1(-cutoff * time), abs=2e-3 * met)


def test_a_disturbance_observer_takes_friction_and_load_off_the_ramp():
    """What is left is the velocity error of the viscous friction, which it knows and leaves."""
    load = np.array([2e-3, -1e-3])
    servo = a_loop(friction=3e-3, kd=8e-4, load_torque=load)
    path = Stroke(*np.array([[0.1] * 2, [0] * 2, [2.0] * 2, [np.inf] * 2, [0] * 2, [0] * 2]))
    numbers = (np.full(2, value) for value in (J, B, 17.0, T))
    left = follow(servo, path, 3.0, DisturbanceObserver(*numbers))[-1]
    assert left == pytest.approx(B * 2.0 / KP, rel=1e-3)
    without = follow(servo, path, 3.0)[-1]
    assert without == pytest.approx((B * 2.0 + 3e-3 + load) / KP, rel=1e-3)


def test_a_lugre_observer_takes_its_share_of_friction_off_the_ramp():
    friction = 3e-3
    servo = a_loop(friction=friction, kd=8e-4)
    observer = LuGreObserver(*(np.array([value]) for value in (0.5 * friction, 0.05, T)))
    left = follow(servo, stroke(begin=0.1, ramp=2.0), 3.0, observer)[-1]
    assert left == pytest.approx((B * 2.0 + 0.5 * friction) / KP, rel=1e-3)


def test_the_lugre_observer_never_pushes_harder_than_half_of_kp():
    for changes in ({}, {"compensation.gain": 5.0}, {"compensation.boundary_rad": 1e-4}):
        some = drawn(changes)
        observer = observers(some)["LuGre observer"]
        assert (observer.full / observer.stretch <= 0.5 * some.kp * (1 + 1e-12)).all()
    assert observer.full.min() > 0


# --- over draws -------------------------------------------------------------------------


def drawn(changes=None, n=16):
    settings = loop(MOVES | SOFT | (changes or {}))
    return at_shaft(
        settings, draw_assembly(settings, posterior(n, sd=0.1), RigDiscrepancy(0.0, ""), 1)
    )


def test_errors_of_a_ramp_are_the_closed_form_draw_by_draw():
    own = {"controller.encoder_counts_per_revolution": 1e8, "compensation.at_rest": "hold"}
    some = drawn(own | {"kick.reference_range_rad_s": [1.0, 3.0]})
    following = follow_all(some, 16)
    ramp = following.trajectories[0].compensators
    cable = some.cable
    for compensator, fed in zip(ramp[:2], (0.0, 1.0), strict=True):
        servo = (some.friction - fed * some.estimate) / some.kp
        wanted = some.tip_per_rad * (servo + cable.rubs[-1] * some.friction / some.stiffness)
        assert compensator.rms_m.q50 == pytest.approx(np.median(np.abs(wanted)), rel=0.02)
        assert compensator.q50_m[-1] == pytest.approx(np.median(wanted), rel=0.02, abs=2e-8)
    assert ramp[0].q50_m[0] == 0.0  # at rest
    assert ramp[0].least == 0.0
    assert max(compensator.least for compensator in ramp) > 0.5
    step = following.trajectories[3].compensators
    assert step[0].q50_m[np.searchsorted(following.time_s, 0.0)] == pytest.approx(
        np.median(some.kick) * some.tip_per_rad[0], rel=0.05
    )


def test_speeds_are_the_files_or_those_of_the_scan():
    assert strokes(drawn())[1]["ramp"][0].ramp[0] == pytest.approx(10 * 2 * np.pi / 4000 / 1e-3)
    own = drawn({"kick.reference_range_rad_s": [0.5, 3.0]})
    rest, paths = strokes(own)
    assert paths["ramp"][0].ramp[0] == pytest.approx(3.0)
    # 3 rad/s of the motor are 171.9°/s, and 15 mm/s at the end of 0.5 m after 1:100
    assert paths["ramp"][1].startswith("172°/s at the motor (15 mm/s at the tip)")
    sine, _ = paths["sine"]
    assert sine.amplitude[0] * sine.omega[0] == pytest.approx(3.0)
    assert sine.omega[0] * rest == pytest.approx(2 * np.pi)


def test_the_band_of_the_error_is_the_files_or_twice_the_stuck_band():
    some = drawn()
    band = with_compensator(some, "error").boundary
    assert band == pytest.approx(2 * some.estimate / some.kp)
    given = drawn({"compensation.boundary_rad": 0.07, "compensation.boundary_rad_s": 0.2})
    assert with_compensator(given, "error").boundary == pytest.approx(0.07)
    assert with_compensator(given, "reference").boundary == pytest.approx(0.2)
    its_own = with_compensator(given, "measured")
    assert its_own.boundary == pytest.approx(0.2)


def test_a_reference_that_never_moves_is_refused(tmp_path):
    draws = write_draws(tmp_path / "draws.nc", n=40)
    with pytest.raises(InputError, match=r"reference_range_rad_s.*never moves"):
        compute_margins(loop(), draws, ensembles=True)


def test_the_verb_stores_and_says_it(tmp_path):
    draws = write_draws(tmp_path / "draws.nc", n=40)
    slow = loop({"kick.reference_range_rad_s": [2.0, 2.0], "compensation.signal": "none"} | STIFF)
    summary = compute_margins(slow, draws, ensembles=True, simulated=6).summary.loops[0]
    assert summary.following is not None
    assert summary.following.draws == 6
    assert [trajectory.name for trajectory in summary.following.trajectories] == [
        "ramp", "reversal", "sine", "step",
    ]  # fmt: skip
    assert "--ensembles" in CliRunner().invoke(app, ["margins", "--help"]).output

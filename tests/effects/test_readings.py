"""Effects on readings move the events' times by as much as they should."""

import numpy as np
import pytest
from scipy import integrate

from bayesfric.effects import Reading, all_effects
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.gravity import Condition, trajectory
from bayesfric.rigs.acting import PhasedEffect
from bayesfric.rigs.gravity_board.simulator import passing_times, trial_motion
from bayesfric.rigs.protocols import Protocol
from bayesfric.rigs.truth import AppliedEffect
from bayesfric.simulate import Truth, simulate_recording

G = 9.80665
SPACING = 0.0098
GRID = SPACING * np.arange(61)
DRIVE, LOAD = np.array([1.7, 1.2]), np.array([1.5, 1.0])
CONDITION = Condition(np.full(2, 9), np.full(2, 85.0), DRIVE, LOAD, G)
LAW = Coefficients(np.full(2, 0.004), np.full(2, 0.016), np.zeros(2))
FIRST = np.array([[0.003, 0.007], [0.0015, 0.0102]])  # trial × sensor
PLACE = FIRST[:, :, None] + GRID


def rigid():
    parts = [np.reshape(np.asarray(part), (-1, 1, 1)) for part in CONDITION]
    return trajectory(Coefficients(*(c[:, None, None] for c in LAW)), Condition(*parts))


def rate():
    """Acceleration of each trial, 9 (0.004 T + 0.016) of friction at its own tension."""
    total, half = DRIVE + LOAD, (DRIVE - LOAD) / 2
    a = (2 * half * G - 9 * 0.004 * total * G / 2 - 9 * 0.016) / (total - 9 * 0.004 * half)
    return a[:, None, None]


def times(name, values, phases=None, motion=None):
    acting = PhasedEffect(AppliedEffect(all_effects()[name], *values), phases)
    return passing_times(motion or rigid(), PLACE, GRID, CONDITION, 5, [acting])


def test_a_longer_spacing_delays_in_proportion_to_travel():
    read = times("length-scale", ("proportional", {"excess": 0.01}))
    assert read == pytest.approx(np.sqrt(2 * (FIRST[:, :, None] + 1.01 * GRID) / rate()), rel=1e-9)


def test_slip_delays_the_load_end_alone():
    read = times("slip", ("proportional", {"share": 0.02}))
    assert read[:, 0] == pytest.approx(np.sqrt(2 * PLACE / rate())[:, 0], rel=1e-9)
    late = np.sqrt(2 * (FIRST[:, :, None] + 1.02 * GRID) / rate())
    assert read[:, 1] == pytest.approx(late[:, 1], rel=1e-9)


def test_creep_is_slip_in_proportion_to_friction():
    """Friction is what the masses pull less what they take to accelerate; its typical value 2 N."""
    friction = (DRIVE - LOAD) * G - (DRIVE + LOAD) * rate()[:, 0, 0]
    assert friction == pytest.approx(9 * (0.004 * ((DRIVE + LOAD) * G - (DRIVE - LOAD)
                                     * rate()[:, 0, 0]) / 2 + 0.016))  # fmt: skip
    read = times("slip", ("creep", {"share": 0.02}))
    assert read[:, 0] == pytest.approx(np.sqrt(2 * PLACE / rate())[:, 0], rel=1e-9)
    share = 1 + 0.02 * friction[:, None] / 2.0
    late = np.sqrt(2 * (FIRST[:, 1, None] + share * GRID) / rate()[:, 0])
    assert read[:, 1] == pytest.approx(late, rel=1e-7)


def test_a_slow_clock_reads_too_long_by_its_share():
    """To first order in 1e-4."""
    read = times("clock-scale", ("proportional", {"excess": 1e-4}))
    assert read == pytest.approx(1.0001 * np.sqrt(2 * PLACE / rate()), rel=2e-8)


def test_any_five_magnets_are_four_waves():
    """Errors of five magnets, none on average, come back each revolution."""
    errors = np.array([3e-4, -1e-4, 2e-4, -5e-4, 1e-4])
    first_up = np.array([[0, 3], [1, 4]])  # which magnet came first
    error = errors[(first_up[:, :, None] + np.arange(61)) % 5]
    waves = np.fft.rfft(error[:, :, :5]) * 2 / 5
    parts = np.stack([waves[..., 1].real, -waves[..., 1].imag, waves[..., 2].real,
                      -waves[..., 2].imag])  # fmt: skip
    # An amplitude of σ means waves of σ/√2 each.
    read = times("magnet-spacing", ("waves", {"error": 1e-3}), parts * np.sqrt(2) / 1e-3)
    assert read == pytest.approx(np.sqrt(2 * (PLACE + error) / rate()), rel=1e-9)


def test_the_amplitude_of_magnets_is_the_rms_error_of_one():
    rng = np.random.default_rng(1)
    phases = rng.standard_normal((4, 2, 2, 4000))
    effect = all_effects()["magnet-spacing"]
    reading = Reading(0.0, np.arange(5.0), 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 5)
    waves = effect.laws["waves"]({"error": 2e-4}, reading)
    errors = np.tensordot(phases, waves, axes=(0, 0))
    assert errors.std(axis=(0, 1, 2)) == pytest.approx(2e-4, rel=4 / np.sqrt(2 * 16_000))
    assert np.abs(errors.sum(axis=-1)).max() < 1e-15


def test_masses_ring_as_equation_3_says():
    """Two masses on a spring, integrated, their ends timed at each magnet."""
    stretch, stiffness, damping = 2e-6, 9000.0, 0.05
    values = {"stretch": stretch, "stiffness": stiffness}
    read = times("cable-compliance", ("ringing", values))
    for trial in range(2):
        drive, load = DRIVE[trial], LOAD[trial]
        total = drive + load
        omega = np.sqrt(stiffness * total / (drive * load))
        # Spring and damper that give this damped frequency and this decay.
        reduced = drive * load / total
        spring, damper = reduced * omega**2 * (1 + damping**2), 2 * reduced * damping * omega
        a = float(rate()[trial, 0, 0])

        def move(t, y, spring=spring, damper=damper, a=a, drive=drive, load=load):
            pull = spring * (y[0] - y[1]) + damper * (y[2] - y[3])  # beyond the rigid board's
            return [y[2], y[3], a - pull / drive, a + pull / load]

        ahead = np.array([load, -drive]) / total * stretch
        start = [*ahead, *(-damping * omega * ahead)]
        solved = integrate.solve_ivp(
            move, (0, 3), start, "DOP853", rtol=1e-11, atol=1e-13, max_step=2e-3, dense_output=True
        )
        for sensor in range(2):
            reached = solved.sol(read[trial, sensor])[sensor]
            # What is left is of second order: the ring's speed times its delay, 1 % here.
            assert np.abs(reached - PLACE[trial, sensor]).max() < 0.02 * stretch


def test_readings_of_a_stepped_motion_are_those_of_the_closed_one():
    still = {"radius_m": np.full(2, 7.82e-3), "order": np.zeros(2), "gravity_m_s2": G}
    stepped = trial_motion(LAW, CONDITION, np.ones(2), [], still, 0.7)
    for name, law, value in (
        ("length-scale", "proportional", {"excess": 0.01}),
        ("clock-scale", "proportional", {"excess": 0.01}),
    ):
        closed = times(name, (law, value))
        assert times(name, (law, value), motion=stepped) == pytest.approx(closed, abs=1e-7)


def test_events_of_a_recording_are_shifted_and_nothing_else():
    """Length scale end to end: times of a noise-free board, to a tick of its clock."""
    quiet = {"tau": 0, "omega": 0, "sigma_x": 1e-12, "sigma_t": 1e-12}
    design = Protocol({(9, 85.0): 1}, (16.0,), (), 2)
    longer = AppliedEffect(all_effects()["length-scale"], "proportional", {"excess": 0.01})
    plain = simulate_recording(design, seed=4, truth=Truth(**quiet))
    shifted = simulate_recording(design, seed=4, truth=Truth(**quiet, effects=(longer,)))
    for (_, before), (_, after) in zip(
        plain.gravity.events.groupby(["trial", "sensor"]),
        shifted.gravity.events.groupby(["trial", "sensor"]),
        strict=True,
    ):
        t, d = before["time_s"].to_numpy(), before["displacement_m"].to_numpy()
        c0, c1, c2 = np.polynomial.polynomial.polyfit(t, d, 2)  # travel against time, exactly
        wanted = 1.01 * after["displacement_m"].to_numpy()
        expected = (-c1 + np.sqrt(c1**2 - 4 * c2 * (c0 - wanted))) / (2 * c2)
        assert after["time_s"].to_numpy() == pytest.approx(expected, abs=1e-5)
    assert shifted.motor.runs.equals(plain.motor.runs)


def test_each_sensor_has_magnets_of_its_own():
    quiet = {"tau": 0, "omega": 0, "sigma_x": 1e-12, "sigma_t": 1e-12}
    design = Protocol({(9, 85.0): 1}, (16.0,), (), 2)
    applied = AppliedEffect(all_effects()["magnet-spacing"], "waves", {"error": 3e-4})
    made = simulate_recording(design, seed=4, truth=Truth(**quiet, effects=(applied,)))
    patterns = []
    for _, group in made.gravity.events.groupby(["trial", "sensor"]):
        t, d = group["time_s"].to_numpy(), group["displacement_m"].to_numpy()
        left = d - np.polynomial.Polynomial.fit(t, d, 2)(t)
        patterns.append([left[k::5].mean() for k in range(5)])
    patterns = np.array(patterns)
    size = np.sqrt((patterns**2).mean())
    assert size == pytest.approx(3e-4, rel=4 / np.sqrt(2 * 4 * len(patterns)))
    assert np.abs(np.corrcoef(patterns) - np.eye(len(patterns))).max() < 0.999

"""STRENGTH 1 is 10 % of friction, rms over the design: sums by another way."""

import numpy as np
import pytest

from bayesfric.effects import State, all_effects
from bayesfric.errors import InputError
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.gravity import Condition, coulomb_acceleration
from bayesfric.rigs.protocols import PROTOCOLS
from bayesfric.simulate import Truth, simulate_recording, table1_coefficients
from bayesfric.simulate.strength import at_strength

G = 9.80665
QUICK = PROTOCOLS["quick"]
U = np.linspace(0, 1, 33)  # of a trial's duration
FINE = np.linspace(0, 1, 4001)


@pytest.fixture(scope="module")
def recording():
    return simulate_recording("quick", seed=0)


@pytest.fixture(scope="module")
def trials(recording):
    """n, m1, m2, acceleration, friction, duration and its slope in T, one row a trial."""
    rows = []
    for row in recording.gravity.trials.itertuples():
        condition = Condition(
            row.n_pulleys, row.wrap_angle_deg, row.mass_drive_kg, row.mass_load_kg, G
        )
        law = table1_coefficients()[row.pulley_size]
        a = float(coulomb_acceleration(law, condition))
        m1, m2 = row.mass_drive_kg, row.mass_load_kg
        friction = (m1 - m2) * G - (m1 + m2) * a
        slope = row.n_pulleys * (law.c1 + law.c3 * (row.wrap_angle_deg - 85))
        rows.append((row.n_pulleys, m1, m2, a, friction, np.sqrt(1.2 / a), slope))
    return np.array(rows)


@pytest.fixture(scope="module")
def runs(recording):
    """Speed and friction, one row a run."""
    rows = []
    for row in recording.motor.runs.itertuples():
        law = Coefficients(*table1_coefficients()[row.pulley_size])
        k = row.n_pulleys * (law.c1 + law.c3 * (row.wrap_angle_deg - 85))
        friction = (k * row.hanging_mass_kg * G + row.n_pulleys * law.c2) / (1 - k / 2)
        rows.append((row.velocity_m_s, friction))
    return np.array(rows)


def amplitude(name, recording, strength=1.0, law=None):
    applied = at_strength(name, strength, QUICK, recording.rig, Truth(), law)
    return applied.values[all_effects()[name].amplitude.name]


def rms(*boards):
    """Of shares of friction: over the times of a row, then over the rows of all boards."""
    rows = np.concatenate([(np.asarray(shares) ** 2).mean(axis=1) for shares in boards])
    return np.sqrt(rows.mean())


def test_forces_on_the_gravity_board_alone(recording, trials):
    n, _, _, a, friction, duration, slope = trials.T[:, :, None]
    x = a * (U * duration) ** 2 / 2
    names = "mass-error cable-weight pulley-inertia presliding hysteresis runout".split()
    at = {name: amplitude(name, recording) for name in names}
    pull = (G - a) * (1 - slope / 2)  # half of it goes into the nominal tension
    assert rms(at["mass-error"] * pull / friction) == pytest.approx(0.1)
    assert rms(at["cable-weight"] * G * (2 * x - 0.6) / friction) == pytest.approx(0.1)
    assert rms(at["pulley-inertia"] * n * a / friction) == pytest.approx(0.1)
    assert rms(at["presliding"] * np.exp(-x / 0.02)) == pytest.approx(0.1)
    assert rms(at["hysteresis"] * np.exp(-x / 0.04)) == pytest.approx(0.1)
    assert at["runout"] == pytest.approx(0.1)  # cos² + sin²


def test_forces_on_both_boards(recording, trials, runs):
    _, _, _, a, friction, duration, _ = trials.T[:, :, None]
    v, rubs = runs.T[:, :, None]
    air = amplitude("air-drag", recording)
    on_trials = air * (a * U * duration) ** 2 / friction
    assert rms(on_trials, air * v**2 / rubs) == pytest.approx(0.1)
    drift = amplitude("wear-drift", recording)
    orders = [np.linspace(0, 1, len(board))[:, None] - 0.5 for board in (trials, runs)]
    assert rms(*(drift * order for order in orders)) == pytest.approx(0.1)


def test_currents_count_over_the_runs_alone(recording, runs):
    rubs = runs[:, 1:]
    offset = amplitude("current-offset", recording)
    assert rms(offset * 0.0259 / 0.0065 / rubs) == pytest.approx(0.1)


def test_readings_that_are_off_in_proportion(recording, trials):
    """What a parabola takes for acceleration: ε a; of a clock twice, of one sensor half."""
    _, m1, m2, a, friction, _, _ = trials.T[:, :, None]
    seen = (m1 + m2) * a / friction
    assert rms(amplitude("length-scale", recording) * seen) == pytest.approx(0.1, rel=1e-5)
    assert rms(amplitude("clock-scale", recording) * 2 * seen) == pytest.approx(0.1, rel=1e-5)
    assert rms(amplitude("slip", recording) / 2 * seen) == pytest.approx(0.1, rel=1e-5)


def test_readings_that_go_to_and_fro(recording, trials):
    """Second derivatives of the mean of both sensors, in closed form."""
    _, m1, m2, a, friction, duration, _ = trials.T[:, :, None]
    t = FINE * duration
    error = amplitude("magnet-spacing", recording)
    squares = 0
    for k in (1, 2):
        # cos and sin of κ x(t) together: κ⁴ v⁴ + κ² a².
        kappa = 2 * np.pi * k / (5 * 0.0098)
        squares = squares + (kappa**4 * (a * t) ** 4 + (kappa * a) ** 2) * error**2 / 2
    assert rms(np.sqrt(squares / 2) * (m1 + m2) / friction) == pytest.approx(0.1, rel=0.01)
    omega = np.sqrt(9400 * (1 / m1 + 1 / m2))
    growth = omega * (-0.05 + 1j)
    bend = (growth**2 * np.exp(growth * t)).real * (m1 - m2) / (m1 + m2) / 2
    stretch = amplitude("cable-compliance", recording)
    assert rms(stretch * bend * (m1 + m2) / friction) == pytest.approx(0.1, rel=0.02)


@pytest.mark.parametrize("name", list(all_effects()))
def test_amplitudes_have_the_sign_of_the_strength_and_grow_with_it(name, recording):
    half, full = (amplitude(name, recording, strength) for strength in (0.5, 1.0))
    assert 0 < half < full
    assert amplitude(name, recording, 0.0) == 0
    assert amplitude(name, recording, -1.0) < 0
    effect = all_effects()[name]
    if effect.along_path or effect.components or effect.acts_on in ("drive", "reading"):
        assert full == pytest.approx(2 * half)


def test_an_unknown_effect_is_refused(recording):
    with pytest.raises(InputError, match="air-drag"):
        amplitude("phlogiston", recording)


@pytest.mark.parametrize("curvature", [-0.3, 0.3])
def test_a_power_of_a_slack_cable_is_a_number(curvature):
    """A law far from a board's trials pulls its cable below nothing; at 16.5 N the effect is 0."""
    tension = np.array([-40.0, 0.0, 16.5])
    state = State.of(Coefficients(0.02, 0.03, 1e-4), 2, 85.0, tension, 0.1)
    force = all_effects()["tension-curvature"].laws["power"]({"curvature": curvature}, state)
    assert np.isfinite(force).all()
    assert force[2] == pytest.approx(0.0, abs=1e-12)

"""A simulated trial with an effect against an integrator of another hand (DOP853)."""

import dataclasses

import numpy as np
import pytest
from scipy import integrate, optimize

from bayesfric.effects import all_effects
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.gravity import Condition
from bayesfric.recording.tables import Pulley
from bayesfric.rigs.acting import PhasedEffect, surroundings
from bayesfric.rigs.gravity_board.simulator import trial_motion
from bayesfric.rigs.protocols import Protocol
from bayesfric.rigs.truth import AppliedEffect
from bayesfric.simulate import Truth, simulate_recording, table1_coefficients
from bayesfric.simulate.strength import at_strength

G = 9.80665
RADIUS = 7.82e-3
N, WRAP, DRIVE, LOAD = 9, 110.0, 1.7, 1.5
C1, C2, C3 = 0.00416, 0.0165, 1.02e-5
FACTOR = 1.1  # scatter: of friction, not of a drive
PLACES = np.array([0.001, 0.01, 0.05, 0.2, 0.4, 0.6])
QUIET = {"tau": 0, "omega": 0, "sigma_x": 1e-12, "sigma_t": 1e-12}
ONE = Protocol({(9, 85.0): 1}, (16.0,), (), 2)
BENT = Protocol({(5, 110.0): 1}, (), (16.0,), 2)


def friction(acceleration):
    tension = ((DRIVE + LOAD) * G - (DRIVE - LOAD) * acceleration) / 2
    return N * ((C1 + C3 * (WRAP - 85)) * tension + C2)


def air(x, v, a):
    return 0.0, 0.3 * v**2


def presliding(x, v, a):
    return -0.6 * friction(a) * np.exp(-x / 0.02), 0.0


def cable(x, v, a):
    return 0.0, -0.02 * G * (2 * x - 0.6)


def cable_off_centre(x, v, a):
    """It hangs equally long after 0.4 m; 1.6 m of it are accelerated."""
    return 0.0, -0.02 * G * (2 * x - 0.8) + 0.02 * 1.6 * a


def inertia(x, v, a):
    return 0.0, 0.03 * N * a


def drive_side(x, v, a):
    """20 g more on the drive side, of whose pull half goes into the nominal tension."""
    return 0.0, -0.02 * (G - a) * (1 - N * (C1 + C3 * (WRAP - 85)) / 2)


def load_side(x, v, a):
    return 0.0, 0.02 * (G + a) * (1 + N * (C1 + C3 * (WRAP - 85)) / 2)


def runout(x, v, a):
    return 0.2 * friction(a) * (0.7 * np.cos(x / RADIUS) - 1.3 * np.sin(x / RADIUS)), 0.0


def hysteresis(x, v, a):
    return -0.6 * friction(a) * (1 - np.tanh(x / 0.08)), 0.0


def drag_with_tension(x, v, a):
    """0.3 N at 15 N, of which two fifths are in proportion to tension."""
    tension = ((DRIVE + LOAD) * G - (DRIVE - LOAD) * a) / 2
    return 0.3 * (0.6 + 0.4 * tension / 15), 0.0


CASES = [
    ("fixed-drag", "with-tension", {"drag": 0.3}, None, drag_with_tension),
    ("air-drag", "quadratic", {"coefficient": 0.3}, None, air),
    ("presliding", "exponential", {"share": 0.6, "length": 0.02}, None, presliding),
    ("hysteresis", "bouc-wen", {"share": 0.6, "length": 0.08}, None, hysteresis),
    ("cable-weight", "passing", {"density": 0.02, "middle": 0.6}, None, cable),
    ("cable-weight", "with-inertia", {"density": 0.02, "middle": 0.8}, None, cable_off_centre),
    ("pulley-inertia", "same", {"mass": 0.03}, None, inertia),
    ("pulley-inertia", "discs", {"mass": 0.03}, None, inertia),  # of the medium size
    ("mass-error", "drive-side", {"excess": 0.02}, None, drive_side),
    ("mass-error", "load-side", {"excess": 0.02}, None, load_side),
    ("runout", "once", {"share": 0.2}, [[0.7], [-1.3]], runout),
]


def acceleration(added, x, v):
    """Of the force balance, solved by bisection: first for the tension, then with scatter."""
    weight = (DRIVE - LOAD) * G

    def rest(a, rubs, factor):
        # Forces on friction at the tension of `rubs`, on the drive at the acceleration itself.
        force = friction(rubs) + added(x, v, rubs)[0]
        return weight - factor * force - added(x, v, a)[1] - (DRIVE + LOAD) * a

    mean = optimize.brentq(lambda a: rest(a, a, 1.0), -20, 20, xtol=1e-15)
    return optimize.brentq(lambda a: rest(a, mean, FACTOR), -20, 20, xtol=1e-15)


@pytest.mark.parametrize(("name", "law", "values", "phases", "added"), CASES)
def test_a_trial_moves_as_another_integrator_says(name, law, values, phases, added):
    ones = np.ones(1)
    effect = PhasedEffect(
        AppliedEffect(all_effects()[name], law, values), phases and np.array(phases)
    )
    motion = trial_motion(
        Coefficients(C1 * ones, C2 * ones, C3 * ones),
        Condition(N * ones, WRAP * ones, DRIVE * ones, LOAD * ones, G),
        FACTOR * ones,
        [effect],
        {"radius_m": RADIUS * ones, "order": ones, "gravity_m_s2": G},
        0.62,
    )
    crossings = [lambda t, y, place=place: y[0] - place for place in PLACES]
    other = integrate.solve_ivp(
        lambda t, y: [y[1], acceleration(added, *y)],
        (0, 5),
        [0, 0],
        "DOP853",
        events=[*crossings, end := lambda t, y: y[0] - 0.61],
        rtol=1e-11,
        atol=1e-13,
        max_step=0.05,
    )
    assert other.success
    expected = [times[0] for times in other.t_events[:-1]]
    assert motion.time_at(PLACES[None])[0] == pytest.approx(expected, abs=1e-7)
    assert end(0, other.y[:, -1]) > 0
    # And the effect is no trifle: it moves the end by far more than that.
    alone = optimize.brentq(lambda a: acceleration(lambda *_: (0.0, 0.0), 0, 0) - a, -20, 20)
    assert abs(expected[-1] - np.sqrt(2 * 0.6 / alone)) > 1e-3


def by_parabola(recording, rows):
    """Friction of whole trials from their own events."""
    forces = []
    for row in rows.itertuples():
        events = recording.gravity.events
        events_of_trial = events[(events["trial"] == row.trial) & (events["sensor"] == "drive")]
        fit = np.polynomial.Polynomial.fit(
            events_of_trial["time_s"], events_of_trial["displacement_m"], 2
        )
        slope = fit.deriv(2)(0.0)
        total = row.mass_drive_kg + row.mass_load_kg
        forces.append((row.mass_drive_kg - row.mass_load_kg) * G - total * slope)
    return np.array(forces)


def by_law(rows, grown):
    """Friction of the law times 1 + grown, its own tension solved for."""
    forces = []
    for row, more in zip(rows.itertuples(), grown, strict=True):
        law = table1_coefficients()[row.pulley_size]
        k = row.n_pulleys * (law.c1 + law.c3 * (row.wrap_angle_deg - 85)) * (1 + more)
        total, half = row.mass_drive_kg + row.mass_load_kg, row.mass_drive_kg - row.mass_load_kg
        half /= 2
        static = k * (total * G / 2 - half * 2 * half * G / total)
        static += row.n_pulleys * law.c2 * (1 + more)
        forces.append(static / (1 - k * half / total))
    return np.array(forces)


@pytest.mark.parametrize("rate", [0.0, -5.0, 3.0])
def test_wear_drift_changes_the_friction_of_first_and_last_trial(rate):
    """In proportion to the trials that were run, run in, or worn ever faster."""
    parameters = {"change": 0.3, "rate": rate}
    drift = AppliedEffect(all_effects()["wear-drift"], "exponential", parameters)
    truth = Truth(**QUIET, effects=(drift,))
    worn = simulate_recording("quick", seed=3, rigs=["gravity"], truth=truth)
    table = worn.gravity.trials
    order = np.linspace(0, 1, 180)
    if rate == 0:
        grown = 0.3 * (order - 0.5)
        assert (grown[0], grown[-1]) == (-0.15, 0.15)
    else:
        grown = 0.3 * (np.exp(rate * order) - 1) / (np.exp(rate) - 1)
        assert grown[-1] == 0.3
        # The mean over the recording is nothing: an integral by hand.
        grown -= 0.3 * (1 / rate - 1 / (np.exp(rate) - 1))
    assert (table["order"].to_numpy() == np.arange(1, 181)).all()
    assert by_parabola(worn, table) == pytest.approx(by_law(table, grown), rel=1e-4)


def test_small_pulleys_that_turn_fast_are_followed():
    """At 1.2 m/s a small pulley turns by 316 rad/s; without friction that follows, exactly.

    Friction of the bearings alone, no tension in it: energy over the travel is in closed
    form, and time is its integral.
    """
    ones, radius, share, m1, m2 = np.ones(1), 3.8e-3, 0.5, 1.0, 0.8
    law = Coefficients(0 * ones, 0.02 * ones, 0 * ones)
    turning = PhasedEffect(
        AppliedEffect(all_effects()["runout"], "once", {"share": share}), np.array([[1.0], [0.0]])
    )
    motion = trial_motion(
        law,
        Condition(N * ones, 85.0 * ones, m1 * ones, m2 * ones, G),
        ones,
        [turning],
        {"radius_m": radius * ones, "order": ones, "gravity_m_s2": G},
        0.62,
    )
    force, mass_kg = N * 0.02, m1 + m2

    def slowness(u):
        x = u**2  # so that the start is no singularity
        work = ((m1 - m2) * G - force) * x - share * force * radius * np.sin(x / radius)
        return 2 * u / np.sqrt(2 * work / mass_kg) if u > 0 else np.sqrt(
            2 * mass_kg / ((m1 - m2) * G - force * (1 + share))
        )  # fmt: skip

    expected = [
        integrate.quad(slowness, 0, np.sqrt(place), limit=500, epsabs=1e-12)[0] for place in PLACES
    ]
    assert motion.time_at(PLACES[None])[0] == pytest.approx(expected, abs=1e-8)


def test_phases_are_drawn_anew_for_every_trial_and_from_a_stream_of_their_own():
    truth = Truth(**QUIET)
    plain = simulate_recording(ONE, seed=5, truth=truth)
    turning = simulate_recording(ONE, seed=5, truth=truth, effects={"runout": 1})
    assert turning.gravity.trials.equals(plain.gravity.trials)
    assert turning.motor.runs.equals(plain.motor.runs)  # what goes round averages out
    assert turning.gravity.events["displacement_m"].equals(plain.gravity.events["displacement_m"])
    late = turning.gravity.events["time_s"] - plain.gravity.events["time_s"]
    last = late.groupby(plain.gravity.events["trial"]).last()
    assert last.round(6).nunique() == len(last)


def test_a_drive_adds_to_the_motor_board_but_what_passes_does_not():
    truth = Truth(tau_motor=0.05, omega_motor=0.05, sigma_current=0, load_noise=0)
    made = {
        name: simulate_recording(ONE, seed=2, truth=truth, rigs=["motor"], effects=effects).motor
        for name, effects in (
            ("plain", None),
            ("air", {"air-drag": 1}),
            ("passing", {"presliding": 1, "hysteresis": 1, "runout": 1, "mass-error": 1,
                         "cable-weight": 1, "pulley-inertia": 1, "slip": 1}),
        )
    }  # fmt: skip
    assert made["passing"].runs.equals(made["plain"].runs)
    runs = made["plain"].runs
    rig = simulate_recording(ONE, rigs=["motor"]).rig
    drag = at_strength("air-drag", 1, ONE, rig, truth).values["coefficient"]
    added = (made["air"].runs["current_a"] - runs["current_a"]) * 0.0259 / 0.0065
    drag_n = drag * runs["velocity_m_s"] ** 2
    # Tension, and with it friction, grows by half the drag.
    laws = [table1_coefficients()[size] for size in runs["pulley_size"]]
    k = runs["n_pulleys"] * [law.c1 + law.c3 * (w - 85) for law, w in
                             zip(laws, runs["wrap_angle_deg"], strict=True)]  # fmt: skip
    scatter = added - drag_n - drag_n * k / 2 / (1 - k / 2)
    # Scatter of 7 % rms multiplies the friction that followed, not the drag.
    assert np.abs(scatter).max() < 0.3 * (drag_n * k / 2).max() + 1e-5


def test_a_motor_that_saturates_is_off_by_more_the_larger_its_load():
    """Twice as far off at 4 A as at 2 A; a torque constant too large needs less current."""
    truth = Truth(idle_current=(0, 0, 0), tau_motor=0, omega_motor=0, sigma_current=0, load_noise=0)
    law = AppliedEffect(all_effects()["torque-constant"], "saturating", {"error": 0.1})
    current = simulate_recording(ONE, seed=2, truth=truth, rigs=["motor"]).motor.runs["current_a"]
    bent = dataclasses.replace(truth, effects=(law,))
    saturated = simulate_recording(ONE, seed=2, truth=bent, rigs=["motor"]).motor.runs["current_a"]
    expected = current / (1 + 0.1 * current.abs() / 4.0)
    assert saturated.to_numpy() == pytest.approx(expected.to_numpy(), abs=2e-6)
    assert (saturated - current).abs().max() > 0.01


def test_a_radius_of_the_users_own_counts():
    recording = simulate_recording("quick", seed=1, rigs=["gravity"])
    rig = dataclasses.replace(recording.rig, pulleys={"small": Pulley(radius_m=0.004)})
    around = surroundings(recording.gravity.trials, rig)
    sizes = recording.gravity.trials["pulley_size"]
    assert set(around["radius_m"][sizes == "small"]) == {0.004}
    assert set(around["radius_m"][sizes == "large"]) == {0.01145}
    assert (around["order"][0], around["order"][-1]) == (0, 1)


@pytest.mark.parametrize("name", list(all_effects()))
def test_every_effect_is_simulated(name):
    """On the board on which it acts, and on no other, something changes."""
    plain = simulate_recording(BENT, seed=8)
    made = simulate_recording(BENT, seed=8, effects={name: 0.3})
    on_motor_alone = all_effects()[name].acts_on == "current"
    assert made.gravity.trials.equals(plain.gravity.trials)
    assert made.gravity.events.equals(plain.gravity.events) == on_motor_alone
    passing = "bed-in cable-compliance cable-weight clock-scale end-asymmetry hysteresis"
    passing += " length-scale magnet-spacing mass-error presliding pulley-inertia runout slip"
    assert made.motor.runs.equals(plain.motor.runs) == (name in passing.split())
    assert made.motor.idle.equals(plain.motor.idle)

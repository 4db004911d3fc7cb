"""The proposed trial, against the two hypotheses' motions written out."""

import numpy as np
import pytest

from bayesfric.analysis import Analysis
from bayesfric.diagnosis.linear_model import LinearModel
from bayesfric.diagnosis.next_experiment import next_experiment
from bayesfric.diagnosis.reference import amplitudes_of, fitted_laws
from bayesfric.diagnosis.weighing import weigh
from bayesfric.effects import all_effects
from bayesfric.effects.candidates import candidates_of
from bayesfric.fitting.hypothesis import Data
from bayesfric.physics.friction import tension_slope
from bayesfric.physics.gravity import Condition, coulomb_acceleration
from bayesfric.rigs.gravity_board.screening import screen_trials
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import simulate_recording, table1_coefficients

GRAVITY = 9.80665
SMALL = Protocol({(9, 85.0): 2, (15, 50.0): 1}, (6.0, 28.0), (6.0, 28.0), 2)


@pytest.fixture(scope="module")
def model():
    recording = simulate_recording(SMALL, seed=5, rigs=("gravity",), effects={"air-drag": 0.3})
    data = Data(recording.rig, screen_trials(recording.gravity, recording.rig).gravity, None)
    candidates = candidates_of(all_effects()["air-drag"])
    return LinearModel(
        data, table1_coefficients(), candidates, Analysis(), 0.005, small=(), discrepancy=False
    )


def test_the_expected_factor_is_half_the_squared_distance_of_two_motions(model):
    psi = model.start
    (proposal,), why = next_experiment(model, psi, {"air-drag": 0.5, "none": 0.5})
    assert why is None
    assert set(proposal.separates) == {"air-drag", "none"}
    told = proposal.condition
    masses = told["mass_drive_kg"], told["mass_load_kg"]
    condition = Condition(told["n_pulleys"], told["wrap_angle_deg"], *masses, GRAVITY)
    found = weigh(model, ("air-drag",), psi, climb=False)
    ((_, drag),) = amplitudes_of(model, psi, found.best)
    size = told["pulley_size"]
    with_it = fitted_laws(model, psi, found.best)[size]
    without = fitted_laws(model, psi, weigh(model, (), psi, climb=False).best)[size]
    reference = float(coulomb_acceleration(model.laws[size], condition))
    mass = told["mass_drive_kg"] + told["mass_load_kg"]
    place = np.arange(0.0049, 0.6, 0.0098)
    time = np.sqrt(2 * place / reference)
    slope = float(tension_slope(model.laws[size], told["n_pulleys"], told["wrap_angle_deg"]))
    # A cable that falls more slowly has more tension, and so more friction.
    mass_felt = mass - slope * (masses[0] - masses[1]) / 2
    # Drag against the speed squared: the fourth power of time.
    distance = (
        coulomb_acceleration(with_it, condition) - coulomb_acceleration(without, condition)
    ) * time**2 / 2 - drag / mass_felt * reference**2 * time**4 / 12
    friction = condition.drive_force_n - mass * reference
    noise = model.noise(psi)[0]
    column = -friction / mass * time**2 / 2
    sd2 = np.mean(model.gravity.rows.variance) * noise.kappa
    covariance = sd2 * np.eye(time.size) + (noise.tau**2 + noise.omega**2) * np.outer(
        column, column
    )
    covariance += 1e3 * (1 + np.outer(time, time))  # where and how fast it was at first
    bound = distance @ np.linalg.solve(covariance, distance) / 2 / np.log(10)
    # What is not known of the two laws takes some of it, little where the data say much; a
    # response is off by a per cent at most, its square by two.
    assert 0.8 * bound < proposal.log10_bayes_factor < 1.02 * bound


def test_nothing_is_proposed_where_nothing_is_open(model):
    assert next_experiment(model, model.start, {"air-drag": 0.97, "none": 0.03})[0] == ()
    why = next_experiment(model, model.start, {"unknown": 0.6, "none": 0.4})[1]
    assert why == "no two hypotheses are left to separate"

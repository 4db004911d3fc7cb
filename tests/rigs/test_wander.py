"""Friction that wanders along the travel: simulated, and found again."""

import numpy as np
import pytest

from bayesfric.analysis import Analysis
from bayesfric.inference.cosines import MODES, cosines
from bayesfric.inference.laplace import laplace_approximation
from bayesfric.inference.model import Model
from bayesfric.physics.gravity import TRAVEL_M
from bayesfric.rigs import all_rigs
from bayesfric.rigs.gravity_board import simulator
from bayesfric.rigs.gravity_board.places import TrialPlaces
from bayesfric.rigs.gravity_board.wander import Wander
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import Truth, simulate_recording

DESIGN = Protocol({(9, 85.0): 2, (15, 50.0): 1, (5, 135.0): 1}, (6.0, 16.0), (6.0, 16.0), 3)


def fitted(truth, seed, design=DESIGN):
    """Return mode and sd of parameters in the sampling space, and the mode by name."""
    recording = simulate_recording(design, seed=seed, truth=truth, rigs=("gravity",))
    model = Model([all_rigs()["gravity"].trials(recording).likelihood(Analysis())])
    laplace = laplace_approximation(model.log_posterior, model.start(), model.scale())
    place = {name: index for index, name in enumerate(model.names)}
    return model, laplace, place


def within(model, laplace, place, truth, name, deviations=4.0):
    natural = model.natural(laplace.mode[None])[0]
    natural[place[name]] = getattr(truth, name)
    there = model.sampling(natural[None])[0, place[name]]
    sd = np.sqrt(laplace.covariance[place[name], place[name]])
    return abs(there - laplace.mode[place[name]]) < deviations * sd


@pytest.mark.parametrize(("seed", "length"), [(3, 0.1), (4, 0.2)])
def test_rms_and_length_of_the_wander_are_found_again(seed, length):
    truth = Truth(wander=0.015, wander_length=length)
    model, laplace, place = fitted(truth, seed)
    for name in ("wander", "wander_length", "tau", "omega", "sigma_x"):
        assert within(model, laplace, place, truth, name), name
    mode = model.by_name(model.natural(laplace.mode[None]))
    assert mode["wander"][0] == pytest.approx(0.015, rel=0.15)


def test_without_wander_none_is_found():
    model, laplace, _ = fitted(Truth(), 5)
    mode = model.by_name(model.natural(laplace.mode[None]))
    assert mode["wander"][0] < 1.5e-3


def test_scatter_of_the_intercept_is_found_beside_that_of_all_friction():
    design = Protocol({(9, 85.0): 6, (15, 50.0): 3, (5, 135.0): 3}, (6.0, 28.0), (6.0, 28.0), 2)
    truth = Truth(omega_intercept=0.1, omega=0.01, tau=0.003)
    model, laplace, place = fitted(truth, 6, design)
    mode = model.by_name(model.natural(laplace.mode[None]))
    assert mode["omega_intercept"][0] == pytest.approx(0.1, rel=0.4)
    assert within(model, laplace, place, truth, "omega_intercept")


def test_a_push_is_no_wander():
    """The first speed is a nuisance of each trial: a push moves no scatter."""
    quiet, pushed = (fitted(Truth(push=push), 7) for push in (0.0, 0.06))
    values = [model.natural(laplace.mode[None])[0] for model, laplace, _ in (quiet, pushed)]
    for name in ("tau", "omega", "sigma_x"):
        assert values[1][quiet[2][name]] == pytest.approx(values[0][quiet[2][name]], rel=0.15)
    assert values[1][quiet[2]["wander"]] < 1.5e-3


def test_the_likelihood_follows_the_cosines_that_are_simulated(monkeypatch):
    """Each cosine of the simulator is that of the likelihood, but for the clock's rounding."""
    amplitude = 0.02

    def one_cosine(truth, count, rng):
        trial = np.arange(count)
        return lambda travel: amplitude * cosines(travel / TRAVEL_M, MODES)[trial % MODES, trial]

    monkeypatch.setattr(simulator, "_draw_wander", one_cosine)
    truth = Truth(tau=0.0, omega=0.0, sigma_x=1e-9, sigma_t=1e-9)
    recording = simulate_recording(DESIGN, seed=8, truth=truth, rigs=("gravity",))
    places = TrialPlaces(recording.gravity, recording.rig)
    columns = Wander(places, Analysis()).columns.travel
    shown = places.condition.drive_force_n - places.condition.total_mass_kg * places.acceleration
    off = []
    for trial, friction in enumerate(shown):
        rows = places.events.trial == trial
        motion = places.events.regressors[:, rows]
        design = np.vstack([columns[:, rows] * friction, motion]).T
        size = np.linalg.norm(design, axis=0)
        solved = np.linalg.lstsq(design / size, places.events.displacement[rows])[0] / size
        off.append(solved[:MODES] / amplitude - (np.arange(MODES) == trial % MODES))
    assert np.sqrt(np.mean(np.square(off), axis=0)).max() < 0.03

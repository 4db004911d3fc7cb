"""Coordinates in which proposals are fitted: round trips, and slopes by differences."""

import numpy as np
import pytest

from bayesfric.families import HalfNormal, LogNormal, Normal
from bayesfric.inference.laplace import Laplace
from bayesfric.inference.model import Model
from bayesfric.inference.priors import Parameter
from bayesfric.inference.proposals import Chart, Proposal

MODEL = Model(
    [],
    [
        Parameter("slope", "1", HalfNormal(scale=0.05), power=1.0),
        Parameter("scatter", "1", HalfNormal(scale=0.05), power=0.5),
        Parameter("length", "m", LogNormal(median=0.1, sd_log=0.5)),
        Parameter("late", "s", Normal(mean=0.0, sd=2.0), power=1.0),
    ],
)
Z = np.random.default_rng(1).standard_normal((50, 4))


def test_coordinates_are_powers_of_the_parameters():
    theta, x = MODEL.natural(Z), MODEL.coordinates(Z)
    assert x[:, 0] == pytest.approx(theta[:, 0])
    assert x[:, 1] == pytest.approx(np.sqrt(theta[:, 1]))
    assert (x[:, 2] == Z[:, 2]).all()
    assert x[:, 3] == pytest.approx(2.0 * Z[:, 3])
    assert MODEL.from_coordinates(x) == pytest.approx(Z, abs=1e-9)


def test_slope_is_that_of_differences():
    step = 1e-5
    by_differences = np.zeros(len(Z))
    for place in range(4):
        moved = step * np.eye(4)[place]
        rise = MODEL.coordinates(Z + moved) - MODEL.coordinates(Z - moved)
        by_differences += np.log(rise[:, place] / (2 * step))
    assert MODEL.coordinates_log_slope(Z) == pytest.approx(by_differences, abs=1e-6)


def test_no_point_lies_where_a_parameter_cannot_be():
    x = MODEL.coordinates(Z[:3])
    x[0, 0] = x[1, 1] = -0.01
    possible = np.isfinite(MODEL.from_coordinates(x)).all(axis=1)
    assert possible.tolist() == [False, False, True]


def test_a_number_far_out_in_its_prior_is_proposed_in_the_sampling_space():
    """At z = −45 a half-normal number underflows to 0 in the coordinates, wherever it is drawn."""
    chart = Chart(MODEL.coordinates, MODEL.from_coordinates, MODEL.coordinates_log_slope)
    mode = np.array([0.3, -45.0, 0.1, 0.2])
    laplace = Laplace(mode, np.diag([0.1, 1.0, 0.2, 0.3]) ** 2, 0.0)
    rng = np.random.default_rng(2)
    proposal = Proposal.at_mode(laplace, chart)
    points, _ = proposal.draw(4000, rng)
    assert points.mean(axis=0) == pytest.approx(mode, abs=0.1)
    again, possible = Proposal.around(points, chart).draw(4000, rng)
    assert possible.all()
    assert again.mean(axis=0) == pytest.approx(mode, abs=0.1)
    assert np.isfinite(MODEL.coordinates_log_slope(points)).all()

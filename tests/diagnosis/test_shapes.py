"""Amplitudes and shapes integrated out, against quadrature."""

import numpy as np
import pytest
from scipy.integrate import dblquad
from scipy.special import log_ndtr
from scipy.stats import multivariate_normal, norm

from bayesfric.analysis import HalfNormal, LogNormal, Normal
from bayesfric.diagnosis.acting import Law
from bayesfric.diagnosis.shapes import Quadratic, choose, log_orthant
from bayesfric.inference.information import Reduced


@pytest.mark.parametrize("correlation", [-0.8, 0.0, 0.6])
@pytest.mark.parametrize("mean", [(1.0, 2.0), (-1.0, 0.5)])
def test_the_probability_of_an_orthant_is_an_integral(mean, correlation):
    covariance = np.array([[1.0, 0.7 * correlation], [0.7 * correlation, 0.49]])
    density = multivariate_normal(mean, covariance).pdf
    chance, _ = dblquad(lambda y, x: density((x, y)), 0, 12, 0, 12, epsabs=1e-9)
    assert log_orthant(np.array(mean), covariance) == pytest.approx(np.log(chance), abs=1e-4)


def test_apart_it_is_a_product_and_together_it_is_not():
    mean, sd = np.array([0.3, -0.2]), np.array([1.0, 2.0])
    assert log_orthant(mean, np.diag(sd**2)) == pytest.approx(log_ndtr(mean / sd).sum(), abs=1e-5)
    tied = np.array([[1.0, -0.95], [-0.95, 1.0]])
    assert log_orthant(np.zeros(2), tied) < 2 * log_ndtr(0.0) - 0.5


@pytest.mark.parametrize("mean", [(1.0, 1.0), (0.0, 0.0), (-0.3, 2.0)])
def test_two_that_are_as_good_as_tied_are_one(mean):
    covariance = np.array([[1.0, 1.0], [1.0, 1.0]])
    assert log_orthant(np.array(mean), covariance) == pytest.approx(log_ndtr(min(mean)))


def test_far_out_it_has_a_logarithm():
    value = log_orthant(np.array([-60.0, 1.0]), np.eye(2))
    assert value == pytest.approx(log_ndtr(-60.0) + log_ndtr(1.0), rel=1e-6)


class Stand:
    """A model that knows priors alone."""

    def __init__(self, *priors):
        self.priors = priors

    def amplitude_prior(self, law):
        return self.priors[0 if law.effect == "one" else 1]


def quadratic(*priors, precision, slope):
    return Quadratic(
        Stand(*priors), Reduced(np.array(precision), np.array(slope), 0.0), range(len(slope))
    )


def test_two_positive_amplitudes_against_quadrature():
    precision, slope = [[4.0, 3.0], [3.0, 5.0]], [1.0, 2.5]
    laws = [Law("one", "a", (0,), (0.0,), 0.0), Law("other", "b", (1,), (0.0,), 0.0)]
    form = quadratic(HalfNormal(scale=1.0), HalfNormal(scale=1.0), precision=precision, slope=slope)
    log_integral = form.values(laws, [np.zeros(1), np.zeros(1)], exact=True)[0]

    def density(y, x):
        at = np.array([x, y])
        likelihood = np.exp(np.array(slope) @ at - 0.5 * at @ np.array(precision) @ at)
        return likelihood * 4 * norm.pdf(x) * norm.pdf(y)

    expected, _ = dblquad(density, 0, 10, 0, 10, epsabs=1e-9)
    assert log_integral == pytest.approx(np.log(expected), abs=1e-3)
    # The product of marginals is another number.
    assert abs(form.values(laws, [np.zeros(1), np.zeros(1)])[0] - log_integral) > 0.01


@pytest.mark.parametrize("strength", [1.0, 30.0, 3000.0])
def test_a_shape_is_integrated_however_well_it_is_known(strength):
    """Data that speak for one shape by any number of nats; a dense sum is the truth.

    Between nodes a column is interpolated, to some 5e-5 of what it explains.
    """
    nodes = np.linspace(-2.4, 2.4, 13)
    shape, grid = 0.37, np.linspace(-2.4, 2.4, 200001)
    # Columns that turn with the shape: their products are cosines of the difference.
    precision = strength * np.cos(0.5 * (nodes[:, None] - nodes))
    slope = strength * np.cos(0.5 * (nodes - shape))
    law = Law("one", "a", tuple(range(13)), tuple(nodes), 0.0)
    form = quadratic(Normal(mean=0.0, sd=1.0), precision=precision, slope=slope)
    (choice,) = choose(form, {"one": (law,)}, ["one"])
    pull = strength * np.cos(0.5 * (grid - shape))
    value = 0.5 * pull**2 / (strength + 1) - 0.5 * np.log(strength + 1) - 0.5 * grid**2
    top = value.max()
    weight = np.exp(-0.5 * grid**2).sum()
    expected = top + np.log(np.exp(value - top).sum() / weight)
    assert choice.log_evidence == pytest.approx(expected, rel=5e-5, abs=0.05)
    if strength > 10:
        assert choice.shapes[0] == pytest.approx(shape, abs=0.1)


def test_a_narrow_maximum_between_places_is_found_beside_one_at_an_edge():
    """A lever half a turn away pulls the other way: it is nearly the same one, at an edge."""
    nodes = np.linspace(-2.4, 2.4, 13)
    shape, turn, strength = 1.454, np.pi / (1.454 + 2.41), 1e5
    precision = strength * np.cos(turn * (nodes[:, None] - nodes))
    slope = strength * np.cos(turn * (nodes - shape))
    law = Law("one", "a", tuple(range(13)), tuple(nodes), 0.0)
    form = quadratic(Normal(mean=0.0, sd=1.0), precision=precision, slope=slope)
    (choice,) = choose(form, {"one": (law,)}, ["one"])
    assert choice.shapes[0] == pytest.approx(shape, abs=0.01)


def turning(other_prior):
    """Two laws with shapes, which pull at what a third law does, and their form."""
    nodes = np.linspace(-2.4, 2.4, 7)
    places = np.concatenate([0.4 * nodes, 0.9 * nodes + 0.5, [0.2]])
    precision = 40 * np.cos(places[:, None] - places) + 3 * np.eye(15)
    laws = [
        Law("one", "a", tuple(range(7)), tuple(nodes), 0.0),
        Law("other", "b", tuple(range(7, 14)), tuple(nodes), 0.0),
        Law("other", "c", (14,), (0.0,), 0.0),
    ]
    slope = 30 * np.cos(places - 0.7)
    return laws, quadratic(HalfNormal(scale=1.0), other_prior, precision=precision, slope=slope)


@pytest.mark.parametrize("which", [0, 1])
def test_along_one_shape_values_are_those_of_whole_matrices(which):
    laws, form = turning(LogNormal(median=1.0, sd_log=0.5))
    grid, shapes = np.linspace(-2.4, 2.4, 11), [0.3, -0.8, 0.0]
    along = form._values_along(laws, shapes, which)(laws[which].weights(grid))
    whole = [np.array([shape]) for shape in shapes]
    whole[which] = grid
    assert along == pytest.approx(form.values(laws, whole), abs=1e-10)
    assert np.ptp(along) > 0.1


def test_combinations_of_laws_at_once_are_each_as_alone():
    laws, form = turning(Normal(mean=0.5, sd=1.0))
    pairs, shapes = [laws[:2], laws[::2], laws[1:]], [(0.3, -0.8), (0.3, 0.0), (1.1, 0.0)]
    at_once = form.each_value(pairs, shapes)
    alone = [
        form.values(pair, [np.array([shape]) for shape in at])[0]
        for pair, at in zip(pairs, shapes, strict=True)
    ]
    assert at_once == pytest.approx(alone, abs=1e-10)
    assert np.ptp(at_once) > 0.1


def test_a_shape_is_not_followed_again_beside_the_same_shapes(monkeypatch):
    """Two effects that share no data: the best shape of either is the same beside any other."""
    nodes = np.linspace(-2.4, 2.4, 13)
    turning = 30.0 * np.cos(0.5 * (nodes[:, None] - nodes))
    precision = np.kron(np.eye(2), turning)
    slope = np.concatenate([turning[4], turning[9]])
    laws = [
        Law("one", "a", tuple(range(13)), tuple(nodes), 0.0),
        Law("other", "b", tuple(range(13, 26)), tuple(nodes), 0.0),
    ]
    form = quadratic(Normal(0.0, 1.0), Normal(0.0, 1.0), precision=precision, slope=slope)
    best = form.choice(laws)
    followed = []

    def along(laws, shapes, which):
        followed.append(which)
        return Quadratic.along(form, laws, shapes, which)

    monkeypatch.setattr(form, "along", along)
    assert form.choice(laws, best.shapes) == best
    assert followed == [0, 1]

"""Deviations of groups and of assemblies, against a dense normal."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from bayesfric.observation.shared_deviation import NestedDeviations, SharedDeviation, indicator

GROUP = np.array([0, 0, 1, 1, 1, 2, 3, 3, 3])
SETUP = np.array([0, 0, 1, 1])
SD = np.array([0.3, 0.8]), np.array([0.5, 0.2])


@pytest.fixture
def rows():
    rng = np.random.default_rng(5)
    moved = rng.standard_normal((GROUP.size, 2))
    return moved, rng.standard_normal((GROUP.size, 3)), rng.standard_normal(GROUP.size)


def nested(rows, variance):
    moved, x, y = rows
    by_group, by_setup = indicator(GROUP, SETUP.size), indicator(SETUP, 2)
    weighted = (moved / variance[:, None], x / variance[:, None], y / variance)
    return NestedDeviations.of(moved, *weighted, by_group, by_setup, SD)


def dense(rows, variance, sd=SD):
    """Return the covariance of the rows, each number drawn by itself."""
    moved = rows[0]
    of_row = SETUP[GROUP]
    covariance = np.diag(variance)
    for codes, scale in ((GROUP, sd[0]), (of_row, sd[1])):
        covariance += np.equal.outer(codes, codes) * ((moved * scale**2) @ moved.T)
    return covariance


def test_density_and_information_are_those_of_the_dense_normal(rows):
    variance = np.linspace(0.2, 1.5, GROUP.size)
    _, x, y = rows
    deviations, whole = nested(rows, variance), dense(rows, variance)
    alone = multivariate_normal(cov=np.diag(variance)).logpdf(y)
    assert alone + deviations.constant == pytest.approx(multivariate_normal(cov=whole).logpdf(y))
    precision, slope = deviations.taken_by(np.ones(4, dtype=bool), np.ones(2, dtype=bool))
    inverse = np.linalg.inv(whole)
    np.testing.assert_allclose(x.T @ (x / variance[:, None]) - precision, x.T @ inverse @ x)
    np.testing.assert_allclose(x.T @ (y / variance) - slope, x.T @ inverse @ y)


def test_sums_are_those_of_the_whole_precision(rows):
    variance = np.linspace(0.2, 1.5, GROUP.size)
    moved, x, y = rows
    deviations, inverse = nested(rows, variance), np.linalg.inv(dense(rows, variance))
    for (columns, response, own), codes in (
        (deviations.of_groups(), GROUP),
        (deviations.of_setups(), SETUP[GROUP]),
    ):
        for number in range(codes.max() + 1):
            lead = moved * (codes == number)[:, None]
            np.testing.assert_allclose(columns[number], lead.T @ inverse @ x)
            np.testing.assert_allclose(response[number], lead.T @ inverse @ y)
            np.testing.assert_allclose(own[number], np.diag(lead.T @ inverse @ lead))
    pulls = moved / variance[:, None]
    columns, response, deviation = (of_group[GROUP] for of_group in deviations.of_rows())
    left = x / variance[:, None] - np.einsum("ir,irk->ik", pulls, columns)
    np.testing.assert_allclose(left, inverse @ x)
    left = y / variance - np.einsum("ir,ir->i", pulls, response)
    np.testing.assert_allclose(left, inverse @ y)
    left = 1 / variance - np.einsum("ir,irs,is->i", pulls, deviation, pulls)
    np.testing.assert_allclose(left, np.diag(inverse))


def test_where_no_group_is_left_nothing_is_taken_up():
    """All assemblies of a size may be held out at once."""
    none = SharedDeviation.of(
        np.zeros((0, 2, 3)), np.zeros((0, 2)), np.zeros((0, 2, 2)), np.ones(2)
    )
    assert none.constant == 0.0
    assert none.left(none.columns).shape == (0, 2, 3)

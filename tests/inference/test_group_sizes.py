"""Draws over the sizes of groups against all combinations of sizes, and closed forms."""

from itertools import product

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from bayesfric.inference.group_sizes import Group, drawn_in_groups

DRAWS = 6000


def group(places, sizes, weights=None):
    sizes = np.array(sizes)
    return Group(np.array(places), sizes, np.zeros(sizes.size) if weights is None else weights)


def exact(precision, slope, mixing, groups):
    """Return mean and covariance of the numbers over all combinations of sizes."""
    design = np.linalg.cholesky(precision).T
    readings = np.linalg.solve(design.T, slope)
    design = design @ mixing
    logs, means, seconds = [], [], []
    for chosen in product(*(range(sized.sizes.size) for sized in groups)):
        variance = np.zeros(mixing.shape[1])
        log = 0.0
        for sized, number in zip(groups, chosen, strict=True):
            variance[sized.places] = sized.sizes[number] ** 2
            log += sized.log_weights[number]
        spread = np.eye(readings.size) + (design * variance) @ design.T
        log += multivariate_normal.logpdf(readings, np.zeros(readings.size), spread)
        gain = variance[:, None] * design.T @ np.linalg.inv(spread)
        mean = gain @ readings
        logs.append(log)
        means.append(mean)
        seconds.append(np.diag(variance) - gain @ (design * variance) + np.outer(mean, mean))
    weights = np.exp(np.array(logs) - max(logs))
    weights /= weights.sum()
    mean = weights @ means
    return mean, np.tensordot(weights, seconds, 1) - np.outer(mean, mean)


def test_draws_are_those_of_all_combinations_of_sizes():
    """Groups that hang together in the data; fewer mixtures are told than there are numbers."""
    rng = np.random.default_rng(3)
    rows = 2 * rng.standard_normal((9, 4))
    mixing = rng.standard_normal((4, 6)) / 2
    precision, slope = rows.T @ rows, np.array([14.0, -3.0, 9.0, 4.0])
    groups = [
        group([0, 3], [0.1, 0.5, 2.0], -np.log([0.1, 0.5, 2.0])),
        group([1], [0.0, 1.0]),
        group([2, 4, 5], [0.2, 1.0]),
    ]
    mean, covariance = exact(precision, slope, mixing, groups)
    drawn = drawn_in_groups(precision, slope, mixing, groups, DRAWS, np.random.default_rng(1))
    sd = np.sqrt(np.diag(covariance))
    assert drawn.shape == (DRAWS, 6)
    # Ten draws have the same sizes: as good as 600 that are independent, or better.
    np.testing.assert_allclose(drawn.mean(axis=0), mean, atol=0.15 * sd.max())
    np.testing.assert_allclose(np.cov(drawn.T), covariance, atol=0.2 * sd.max() ** 2)


def test_one_large_group_among_many_small_ones_is_not_shrunk_to_their_size():
    """Apart in the data, each group has its closed form, whatever sizes the others have."""
    count, precision, sizes = 30, np.full(30, 400.0), np.array([0.1, 1.0])
    slope = np.zeros(count)
    slope[0] = precision[0] * 0.4
    groups = [group([place], sizes) for place in range(count)]
    drawn = drawn_in_groups(
        np.diag(precision), slope, np.eye(count), groups, DRAWS, np.random.default_rng(1)
    )
    spread2 = 1 / precision[0] + sizes**2
    chance = np.exp(-0.5 * 0.4**2 / spread2) / np.sqrt(spread2)
    expected = (chance / chance.sum()) @ (0.4 * sizes**2 / spread2)
    assert expected > 0.39
    assert drawn[:, 0].mean() == pytest.approx(expected, abs=0.01)
    # Of one size with 29 that are nothing it would be 0.32, by a prior of 0.1.
    none = 1 / np.sqrt(spread2)
    variance = (none / none.sum()) @ (sizes**2 / (1 + 400 * sizes**2))
    assert drawn[:, 1:].var() == pytest.approx(variance, rel=0.1)


def test_what_no_data_tell_of_is_drawn_from_its_prior():
    """A share of none half of the time, of one the other half."""
    groups = [group([0], [0.0, 1.0]), group([1], [1.0])]
    drawn = drawn_in_groups(
        np.diag([0.0, 50.0]), np.zeros(2), np.eye(2), groups, DRAWS, np.random.default_rng(2)
    )
    assert np.mean(drawn[:, 0] == 0) == pytest.approx(0.5, abs=0.06)
    assert drawn[:, 0].var() == pytest.approx(0.5, abs=0.06)
    assert drawn[:, 1].var() == pytest.approx(1 / 51, rel=0.1)


def test_a_hypothesis_that_gets_no_draw_has_none():
    """Of draws that are shared over hypotheses, a rare one may get none."""
    groups = [group([0], [1.0])]
    drawn = drawn_in_groups(np.eye(1), np.zeros(1), np.eye(1), groups, 0, np.random.default_rng(1))
    assert drawn.shape == (0, 1)

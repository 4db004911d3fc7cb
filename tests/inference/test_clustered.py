"""Errors of least squares by whole groups, against cases that are known in closed form."""

import numpy as np
import pytest

from bayesfric.inference.clustered import clustered_covariance


def test_a_mean_of_groups_is_as_uncertain_as_its_groups():
    """Of eight groups with five equal rows each, only eight values count."""
    rng = np.random.default_rng(1)
    values = rng.standard_normal(8)
    groups = np.repeat(np.arange(8), 5)
    residuals = (values - values.mean())[groups]
    ones = np.ones((40, 1))
    covariance = clustered_covariance(ones, residuals, groups, np.linalg.inv(ones.T @ ones))
    assert covariance[0, 0] == pytest.approx(np.var(values) / 8)


def test_groups_of_one_row_have_the_error_of_unequal_scatter():
    """The sandwich of White (1980), summed row by row."""
    rng = np.random.default_rng(2)
    design, residuals = rng.standard_normal((30, 2)), rng.standard_normal(30)
    inverse = np.linalg.inv(design.T @ design)
    meat = sum(residuals[row] ** 2 * np.outer(design[row], design[row]) for row in range(30))
    covariance = clustered_covariance(design, residuals, np.arange(30), inverse)
    np.testing.assert_allclose(covariance, inverse @ meat @ inverse)

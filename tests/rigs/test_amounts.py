"""Amounts of forces beside the law are integrated out as the normal density has it."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from bayesfric.rigs.single_axis.beside import Amounts


@pytest.mark.parametrize("count", [0, 1, 7])
def test_the_density_is_that_of_rows_whose_covariance_has_the_amounts(count):
    rng = np.random.default_rng(count)
    force, law = rng.standard_normal((20, 1)), rng.standard_normal((20, 5))
    beside = rng.standard_normal((20, count)) * rng.uniform(0.1, 3.0, count)
    data = np.hstack([force, law, beside])
    amounts = Amounts.of(data.T @ data)
    numbers = rng.standard_normal((6, 5))
    left = np.hstack([np.ones((6, 1)), -numbers])
    rest = left @ amounts.without_modes(data).T
    log_density = -0.5 * (rest**2).sum(axis=1) + amounts.log_density(left, np.ones(6))
    whole = multivariate_normal(cov=np.eye(20) + beside @ beside.T)
    exact = whole.logpdf(force[:, 0] - numbers @ law.T) + 10 * np.log(2 * np.pi)
    assert log_density == pytest.approx(exact, abs=1e-9)


def test_larger_errors_leave_less_told():
    """Of rows with errors of s the determinant is |1 + B'B / s²|."""
    beside = np.random.default_rng(1).standard_normal((20, 3))
    data = np.hstack([np.zeros((20, 6)), beside])
    log_density = Amounts.of(data.T @ data).log_density(np.zeros((1, 6)), np.array([2.0]))
    exact = -0.5 * np.linalg.slogdet(np.eye(3) + beside.T @ beside / 4)[1]
    assert log_density == pytest.approx(exact)

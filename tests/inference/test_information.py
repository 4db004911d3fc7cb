"""Information of which rounding leaves no sum of squares."""

import numpy as np
import pytest

from bayesfric.inference.information import Information


@pytest.mark.parametrize("size", [1e6, 1e14, 1e24, 1e40])
def test_information_that_is_as_large_as_it_likes_can_be_integrated(size):
    """Two numbers of which the data tell one sum: the other keeps its prior's width."""
    rng = np.random.default_rng(0)
    tell = rng.standard_normal((3, 6)) * np.sqrt(size)
    information = Information(tell.T @ tell, np.zeros(6), 0.0)
    value, mean, covariance = information.integrated(np.zeros(6), np.ones(6))
    assert np.isfinite(value)
    assert np.all(mean == 0)
    assert np.all(np.diag(covariance) > 0)
    reduced = information.reduced(np.zeros(6), np.full(6, 1e3), np.array([5]))
    assert np.isfinite(reduced.precision).all()

"""Draws given more data, against the conjugate normal posterior of all data."""

import numpy as np

from bayesfric.inference.laplace import Laplace
from bayesfric.inference.more_data import draws_with_more_data
from bayesfric.inference.proposals import SAMPLING_SPACE

SIZE = 8000
PRIOR_SD = 2.0


def draws(read, sd, size=SIZE, first_size=4000):
    """Draws of x ~ N(1, 0.5²) and y ~ N(0, 2²) given that x + y was read with an error `sd`."""
    first = 1 + 0.5 * np.random.default_rng(5).standard_normal((first_size, 1))

    def log_density(x, y):
        return (-0.5 * ((read - x - y) / sd) ** 2 - 0.5 * (y / PRIOR_SD) ** 2)[:, 0]

    precision = sd**-2 + PRIOR_SD**-2
    laplace = Laplace(np.array([(read - 1) / sd**2 / precision]), np.array([[1 / precision]]), 0.0)
    return draws_with_more_data(log_density, first, np.ones(1), laplace, 3, SAMPLING_SPACE, size)


def posterior(read, sd):
    """Return mean and covariance of x and y in closed form."""
    precision = np.diag([0.5**-2, PRIOR_SD**-2]) + sd**-2
    covariance = np.linalg.inv(precision)
    return covariance @ np.array([0.5**-2 + read / sd**2, read / sd**2]), covariance


def test_draws_are_those_given_all_data():
    sd = 0.6
    mean, covariance = posterior(3.0, sd)
    drawn = draws(3.0, sd)
    assert drawn.shape == (SIZE, 2)
    error = np.sqrt(np.diag(covariance) / 800)  # a tenth of the points counts, at least
    assert np.abs((drawn.mean(axis=0) - mean) / error).max() < 3
    np.testing.assert_allclose(np.cov(drawn.T), covariance, atol=0.12 * covariance.max())


def test_more_data_that_contradict_the_first_have_no_reliable_weights():
    """Six standard deviations of x and y together away, known to a hundredth."""
    assert draws(40.0, 0.01) is None

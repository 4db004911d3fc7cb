"""Mode and curvature of densities whose answers are known."""

import numpy as np
import pytest

from bayesfric.inference.laplace import (
    NoModeError,
    curvature_steps,
    finite_hessian,
    laplace_approximation,
)

PRECISION = np.array([[4.0, 1.0, 0.0], [1.0, 900.0, -20.0], [0.0, -20.0, 1e8]])
MODE = np.array([1.0, -2.0, 3e-4])


def gaussian(points):
    off = points - MODE
    return -0.5 * np.einsum("wi,ij,wj->w", off, PRECISION, off) + 7.0


def test_gaussian_is_found_exactly_from_afar():
    laplace = laplace_approximation(gaussian, np.array([30.0, 40.0, -1.0]), np.ones(3))
    assert laplace.log_density == pytest.approx(7.0, abs=1e-4)
    assert laplace.covariance == pytest.approx(np.linalg.inv(PRECISION), rel=1e-4)
    off = laplace.mode - MODE
    assert off @ PRECISION @ off < 1e-4


def test_skewed_density_gives_mode_and_curvature():
    # log of a gamma(5, 1) variable: density e^{5z − e^z}, mode log 5, curvature 5.
    laplace = laplace_approximation(
        lambda z: (5 * z - np.exp(z))[:, 0], np.array([-3.0]), np.ones(1)
    )
    # Central differences over a step h = 0.2/√5 move the mode by h²/6.
    assert laplace.mode[0] == pytest.approx(np.log(5.0) - 0.04 / 5 / 6, abs=2e-4)
    assert laplace.covariance[0, 0] == pytest.approx(0.2, rel=0.02)


def test_hessian_of_a_correlated_density():
    hessian = finite_hessian(gaussian, MODE + 0.01, np.array([0.5, 0.03, 1e-4]))
    assert -hessian == pytest.approx(PRECISION, rel=1e-5, abs=1e-3)


def test_steps_follow_the_curvature():
    steps = curvature_steps(gaussian, MODE, np.ones(3))
    assert steps == pytest.approx(1 / np.sqrt(np.diag(PRECISION)), rel=1e-3)


def test_a_good_guess_of_the_steps_takes_one_call():
    asked = []

    def counted(z):
        asked.append(len(z))
        return gaussian(z)

    right = 1 / np.sqrt(np.diag(PRECISION))
    assert curvature_steps(counted, MODE, np.ones(3), 1.05 * right) == pytest.approx(
        right, rel=1e-3
    )
    assert asked == [7]
    bad = curvature_steps(counted, MODE, np.ones(3), 50 * right)
    assert bad == pytest.approx(right, rel=1e-3)


def test_flat_direction_keeps_a_finite_width():
    flat = laplace_approximation(lambda z: -0.5 * z[:, 0] ** 2, np.zeros(2), np.full(2, 3.0))
    assert np.isfinite(flat.covariance).all()
    assert flat.covariance[0, 0] == pytest.approx(1.0, rel=1e-3)
    assert flat.covariance[1, 1] >= 9.0


def test_impossible_start_is_an_error():
    with pytest.raises(ValueError, match="not finite"):
        laplace_approximation(lambda z: np.full(len(z), -np.inf), np.zeros(1), np.ones(1))


def test_density_without_a_bound_has_no_mode():
    """Of noise that vanishes: finite at every point but the one that is climbed to."""

    def cusp(z):
        with np.errstate(divide="ignore"):
            return -np.log(np.maximum(np.abs(z[:, 0]) - 0.5, 0.0))

    with pytest.raises(NoModeError, match="no finite curvature"):
        laplace_approximation(cusp, np.array([0.6]), np.ones(1))

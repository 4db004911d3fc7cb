"""Smooth forces against the Gaussian process that they stand for."""

import numpy as np
import pytest

from bayesfric.inference.smooths import smooth_along

PLACES = np.linspace(2.0, 5.0, 40)


def squared_exponential(values, span):
    return np.exp(-0.5 * ((values[:, None] - values) / (span / 3)) ** 2)


def test_covariance_is_that_of_the_kernel():
    columns = smooth_along({"tension": (2.0, 5.0)}).columns({"tension": PLACES})
    kernel = squared_exponential(PLACES, 3.0)
    # 0.5 % of the variance is cut off; at the ends somewhat more of it.
    np.testing.assert_allclose(columns.T @ columns, kernel, atol=0.03)


def test_a_relative_force_is_twice_as_narrow():
    columns = smooth_along({"order": (2.0, 5.0)}, relative=True).columns({"order": PLACES})
    np.testing.assert_allclose(columns.T @ columns, squared_exponential(PLACES, 1.5), atol=0.06)


def test_two_axes_are_a_product():
    rng = np.random.default_rng(0)
    where = {"velocity": rng.uniform(0, 1, 30), "tension": rng.uniform(2, 5, 30)}
    smooth = smooth_along({"velocity": (0.0, 1.0), "tension": (2.0, 5.0)})
    columns = smooth.columns(where)
    kernel = squared_exponential(where["velocity"], 1.0) * squared_exponential(
        where["tension"], 3.0
    )
    np.testing.assert_allclose(columns.T @ columns, kernel, atol=0.05)


@pytest.mark.parametrize("limits", [(1.0, 1.0)])
def test_what_does_not_vary_has_no_smooth(limits):
    assert smooth_along({"wrap_angle": limits}) is None


def test_outside_the_range_a_force_is_that_of_the_edge():
    smooth = smooth_along({"tension": (2.0, 5.0)})
    beyond, edge = (smooth.columns({"tension": np.array([at])}) for at in (9.0, 5.0))
    np.testing.assert_array_equal(beyond, edge)


def test_a_constant_has_no_axis():
    smooth = smooth_along({}, "motor", relative=True)
    columns = smooth.columns({"tension": PLACES, "velocity": PLACES})
    np.testing.assert_array_equal(columns, np.ones((1, PLACES.size)))
    assert (smooth.count, smooth.axis) == (1, "rig")

"""What a recalibrated law takes up of a force, on a driven axis: its own numbers, and no more."""

from dataclasses import replace

import numpy as np
import pytest
from diagnosis.driven_axis import model_of_axis

from bayesfric.diagnosis.residuals import residuals_of


@pytest.fixture(scope="module")
def residuals(driven_axis):
    model, psi = model_of_axis(driven_axis, lambda effect: [])
    return residuals_of(model, psi)


@pytest.mark.parametrize(
    "force",
    [
        lambda windows: np.ones(windows.size.size),  # Coulomb friction
        lambda windows: windows.covariates["velocity"],
        lambda windows: windows.covariates["direction"],  # an offset, in the sense of the way
    ],
    ids=["coulomb", "viscous", "offset"],
)
def test_nothing_is_left_of_a_force_that_the_law_has(residuals, force):
    left = residuals.without_law(0.3 * force(residuals))
    np.testing.assert_allclose(left, 0.0, atol=1e-3)


def test_a_force_along_the_path_is_left(residuals):
    path = residuals.covariates["displacement"]
    left = residuals.without_law(path - path.mean())
    assert np.std(left) > 0.5 * np.std(path)


@pytest.mark.parametrize(("pull", "left"), [(10.0, 0.0), (1e-6, 1.0)], ids=["wide", "narrow"])
def test_a_pull_of_unknown_amount_is_taken_up_as_far_as_its_prior_goes(residuals, pull, left):
    """A force along the path is such a pull: at an amount of 0.1, or at one of a million."""
    path = residuals.without_law(residuals.covariates["displacement"])
    path /= np.sqrt(residuals.weight @ path**2)
    columns = np.column_stack([residuals.columns, pull * path])
    beside = replace(residuals, columns=columns, beside=(columns.shape[1] - 1,))
    np.testing.assert_allclose(beside.without_law(path), left * path, atol=0.01)
    numbers = beside.taken_by_law(path[:, None])
    np.testing.assert_allclose(numbers, 0.0, atol=0.01)

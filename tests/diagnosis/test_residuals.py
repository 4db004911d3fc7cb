"""The law recalibrated to forces: laws that are known."""

from dataclasses import replace

import numpy as np
import pytest

from bayesfric.analysis import Analysis
from bayesfric.diagnosis.linear_model import Acting, LinearModel
from bayesfric.diagnosis.residuals import fitted, recalibrated, residuals_of
from bayesfric.fitting.hypothesis import Data
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import simulate_recording, table1_coefficients

PROTOCOL = Protocol({(9, 85.0): 2, (15, 50.0): 2}, (6.0, 28.0), (6.0, 28.0), 2)


@pytest.fixture(scope="module")
def boards():
    """A model without discrepancy, its windows, and numbers of another law."""
    recording = simulate_recording(PROTOCOL, seed=5)
    data = Data(recording.rig, recording.gravity, recording.motor)
    model = LinearModel(data, table1_coefficients(), (), Analysis(), 0.005, discrepancy=False)
    residuals = residuals_of(model, model.start)
    numbers, _ = fitted(model, model.start, Acting())
    mean = model.prior(())[0]
    numbers[:9] = mean[:9] + np.random.default_rng(3).normal(0, 0.2, 9)
    exact = residuals.residual_n - residuals.left(model, numbers)
    return model, replace(residuals, residual_n=exact), numbers


def test_a_law_that_explains_all_forces_is_found(boards):
    """Up to the prior, which counts as one assembly beside many."""
    model, residuals, numbers = boards
    start = numbers.copy()
    start[:9] = 0.0
    everywhere = np.ones(residuals.size.size, dtype=bool)
    found = recalibrated(model, residuals, everywhere, start)
    left = residuals.left(model, found)
    assert np.sqrt((residuals.weight * left**2).sum()) < 2e-3
    np.testing.assert_array_equal(found[9:], numbers[9:])


def test_windows_that_are_left_out_do_not_enter(boards):
    model, residuals, numbers = boards
    rows = residuals.setup % 3 > 0
    wild = replace(residuals, residual_n=np.where(rows, residuals.residual_n, 1e3))
    np.testing.assert_array_equal(
        recalibrated(model, wild, rows, numbers), recalibrated(model, residuals, rows, numbers)
    )


def test_it_is_the_posterior_of_forces_whose_assemblies_scatter(boards):
    """Against the normal equations of a stacked least squares, prior rows and all."""
    model, residuals, numbers = boards
    noisy = residuals.residual_n + np.random.default_rng(4).normal(0, 0.05, residuals.size.size)
    residuals = replace(residuals, residual_n=noisy)
    everywhere = np.ones(residuals.size.size, dtype=bool)
    found = recalibrated(model, residuals, everywhere, numbers)
    mean, sd = (values[:9] for values in model.prior(()))
    held = numbers.copy()
    held[:9] = 0.0
    design = np.zeros((noisy.size, 9))
    for row, size in enumerate(residuals.size):
        design[row, 3 * size : 3 * size + 3] = residuals.columns[row, :3]
    # One assembly's share of the information, of windows that scatter and are measured alike.
    scatter2 = residuals.friction_n**2 * (residuals.scatter**2).sum(axis=1)
    total = residuals.weight @ scatter2
    good = scatter2 / (scatter2 + residuals.variance)
    root = np.sqrt(residuals.weight * good * np.unique(residuals.setup).size / total)
    rows = np.vstack([root[:, None] * design, np.diag(1 / sd)])
    wanted = np.concatenate([root * residuals.left(model, held), mean / sd])
    expected = np.linalg.lstsq(rows, wanted, rcond=None)[0]
    np.testing.assert_allclose(found[:9], expected, rtol=1e-6, atol=1e-9)


def test_where_nothing_enters_the_law_is_the_prior(boards):
    model, residuals, numbers = boards
    nowhere = np.zeros(residuals.size.size, dtype=bool)
    found = recalibrated(model, residuals, nowhere, numbers)
    np.testing.assert_array_equal(found[:9], model.prior(())[0][:9])
    np.testing.assert_array_equal(found[9:], numbers[9:])


def test_a_coefficient_that_is_held_stays(boards):
    model, residuals, numbers = boards
    held = LinearModel(
        model.data, model.laws, (), Analysis(), 0.005, frozenset({"c3"}), discrepancy=False
    )
    everywhere = np.ones(residuals.size.size, dtype=bool)
    found = recalibrated(held, residuals, everywhere, numbers)[:9].reshape(3, 3)
    assert not found[:, 2].any()
    assert found[:, :2].all()

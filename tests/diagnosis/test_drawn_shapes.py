"""Numbers of a joint beside an effect whose shape nobody knows: as wide as over all its shapes."""

from types import SimpleNamespace

import numpy as np
import pytest
from rigs.joints import Joint

from bayesfric.analysis import Analysis
from bayesfric.diagnosis import left_open
from bayesfric.diagnosis.acting import Acting
from bayesfric.diagnosis.at_shapes import numbers_at_shapes
from bayesfric.diagnosis.baseline import data_of, fitted_baseline
from bayesfric.diagnosis.left_open import drawn_numbers
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.shipped import shipped_of
from bayesfric.effects import all_effects
from bayesfric.effects.candidates import candidates_of
from bayesfric.rigs.opening import with_own_priors

DRAWS = 4000
LEAST = 12  # angles that an expectation is over
SIZE = 1e-4  # of small amounts, where none is there
SHARPER = 7.0  # logarithm of by how much errors are smaller, so that an angle is well known


@pytest.fixture(scope="module")
def swing():
    """A joint with a weight on a short stroke, on which its angle trades with the offset."""
    joint = Joint(strokes_rad=(0.45, 0.1), noise=0.02, seconds=5.0, sampled_hz=100.0)
    data, law = data_of(joint.recording(), "coulomb-viscous", None)
    analysis = with_own_priors(Analysis(), data.rigs)
    data, _, laws, psi = fitted_baseline(data, analysis, frozenset(), shipped_of(None, data), law)
    candidates = candidates_of(all_effects(None)["gravity-torque"])

    def model(discrepancy):
        return LinearModel(data, laws, candidates, analysis, discrepancy=discrepancy)

    return model, psi


def over_all_angles(model, psi, size):
    """Return the best angle, and means and deviations over angles, each with its evidence.

    Each is normal given its angle, beside small amounts and smooth forces of a size.
    """
    (lever,) = model.lawbook["gravity-torque"]
    prior = model.prior([model.amplitude_prior(lever)], discrepancy=size)

    def at(shape):
        return model.evaluate(psi, Acting((lever,), (float(shape),)))

    grid, reached = np.linspace(-1.2, 1.2, 81), 0
    while reached < LEAST:  # of the angles, some with a chance that counts
        levels = [at(shape).information.integrated(*prior) for shape in grid]
        values, means, covariances = zip(*levels, strict=True)
        logs = np.array(values) - grid**2 / 2
        chance = np.exp(logs - logs.max())
        best, reached = float(grid[np.argmax(chance)]), int((chance > 1e-3).sum())
        tried, grid = grid, best + 0.2 * (grid - grid.mean())
    chance /= chance.sum()
    mean = chance @ np.stack(means)
    variances = np.stack([np.diag(covariance) for covariance in covariances])
    sd = np.sqrt(chance @ (variances + np.stack(means) ** 2) - mean**2)
    acting = Acting((lever,), (best,))
    weighed = SimpleNamespace(acting=acting, at=at(best), forms={}, names=("gravity-torque",))
    return weighed, mean, sd, np.sqrt(variances[np.flatnonzero(tried == best)[0]])


def test_numbers_are_as_wide_as_over_all_angles_of_a_weight(swing):
    model = swing[0](False)
    best, mean, expected, at_best = over_all_angles(model, swing[1], 1.0)
    rng = np.random.default_rng(1)
    drawn = rng.multivariate_normal(best.at.mean, best.at.covariance, DRAWS)
    moved, (angle,) = numbers_at_shapes(model, best, None, {}, drawn, rng)
    assert np.std(moved, axis=0) == pytest.approx(expected, rel=0.08)
    assert np.all(np.abs(moved.mean(axis=0) - mean) < 0.15 * expected)
    assert expected[-1] > 1.3 * at_best[-1]  # the offset
    assert abs(np.corrcoef(angle, moved[:, -1])[0, 1]) > 0.5


def test_small_amounts_that_are_not_there_take_nothing_of_what_an_angle_moves(swing, monkeypatch):
    """They could be thousands of times as large: then another lever would stand for the angle."""
    monkeypatch.setattr(left_open, "SIZES", np.array([SIZE]))
    model = swing[0](True)
    best, _, expected, at_best = over_all_angles(model, swing[1] - SHARPER, SIZE)
    rng = np.random.default_rng(1)
    drawn = drawn_numbers(model, best, DRAWS, rng)
    moved, _ = numbers_at_shapes(model, best, None, {}, drawn, rng)
    assert expected[-1] > 1.3 * at_best[-1]
    assert np.std(moved[:, -1]) == pytest.approx(expected[-1], rel=0.08)

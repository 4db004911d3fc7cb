"""Numbers of a joint beside an effect whose shape nobody knows: as wide as over all its shapes."""

from types import SimpleNamespace

import numpy as np
import pytest
from rigs.joints import Joint

from bayesfric.analysis import Analysis
from bayesfric.diagnosis.acting import Acting
from bayesfric.diagnosis.baseline import data_of, fitted_baseline
from bayesfric.diagnosis.effect_draws import drawn_shapes, numbers_at_shapes
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.shipped import shipped_of
from bayesfric.effects import all_effects
from bayesfric.effects.candidates import candidates_of
from bayesfric.rigs.opening import with_own_priors

DRAWS = 4000


def test_numbers_are_as_wide_as_over_all_angles_of_a_weight():
    """On a short stroke the angle trades with the offset.

    Expected are moments over a grid of angles, each with its evidence and its own normal density.
    """
    joint = Joint(strokes_rad=(0.45, 0.1), noise=0.02, seconds=5.0, sampled_hz=100.0)
    recording = joint.recording()
    data, law = data_of(recording, "coulomb-viscous", None)
    analysis = with_own_priors(Analysis(), data.rigs)
    shipped = shipped_of(None, data)
    data, _, laws, psi = fitted_baseline(data, analysis, frozenset(), shipped, law)
    candidates = candidates_of(all_effects(None)["gravity-torque"])
    model = LinearModel(data, laws, candidates, analysis, discrepancy=False)
    (lever,) = model.lawbook["gravity-torque"]

    def at(shape):
        return model.evaluate(psi, Acting((lever,), (shape,)))

    grid = np.linspace(-1.2, 1.2, 81)
    levels = [at(float(shape)) for shape in grid]
    logs = np.array([level.value for level in levels]) - grid**2 / 2
    best, chance = int(np.argmax(logs)), np.exp(logs - logs.max())
    chance /= chance.sum()
    means = np.stack([level.mean for level in levels])
    mean = chance @ means
    variance = chance @ (np.stack([np.diag(level.covariance) for level in levels]) + means**2)
    expected = np.sqrt(variance - mean**2)

    acting = Acting((lever,), (float(grid[best]),))
    weighed = SimpleNamespace(acting=acting, at=levels[best], forms={})
    rng = np.random.default_rng(1)
    drawn = rng.multivariate_normal(levels[best].mean, levels[best].covariance, DRAWS)
    shapes = drawn_shapes(model, weighed, DRAWS, rng)
    moved = numbers_at_shapes(model, weighed, None, {}, drawn, shapes)

    assert np.std(moved, axis=0) == pytest.approx(expected, rel=0.08)
    assert np.all(np.abs(moved.mean(axis=0) - mean) < 0.15 * expected)
    offset = moved.shape[1] - 1
    assert expected[offset] > 1.3 * np.sqrt(levels[best].covariance[offset, offset])

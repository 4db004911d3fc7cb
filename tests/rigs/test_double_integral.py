import numpy as np
import pytest

from bayesfric.rigs.gravity_board import paths
from bayesfric.rigs.gravity_board.paths import POINTS, DoubleIntegral

STEP_S = np.array([0.01, 0.02, 0.015])  # of the grids of three trials
ROWS = (4, 1, 6)


@pytest.mark.parametrize("rows_at_once", [1, 5, 4096])
def test_accelerations_along_the_paths_of_trials_are_integrated_twice(monkeypatch, rows_at_once):
    monkeypatch.setattr(paths, "ROWS_AT_ONCE", rows_at_once)
    trial = np.repeat(np.arange(3), ROWS)
    rng = np.random.default_rng(3)
    place = rng.uniform(0, POINTS - 1, trial.size)
    tau = place * STEP_S[trial]
    at = np.arange(POINTS) * STEP_S[:, None]
    constant, growing = np.broadcast_to([[2.0], [3.0], [-1.0]], at.shape), 6 * at
    of_trials = DoubleIntegral(trial, place, STEP_S[trial], 3)
    displacement = of_trials.of(np.stack([constant, growing]))
    np.testing.assert_allclose(displacement[:, 0], constant[trial, 0] * tau**2 / 2, rtol=1e-12)
    np.testing.assert_allclose(displacement[:, 1], tau**3, rtol=1e-9, atol=1e-12)

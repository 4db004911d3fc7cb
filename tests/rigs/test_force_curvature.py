"""The second derivative of a force near a reversal, against closed forms."""

import numpy as np
import pytest

from bayesfric.rigs.single_axis.even_log import even_grid
from bayesfric.rigs.single_axis.force_rates import force_curvature
from bayesfric.rigs.single_axis.weak_form import test_function as bump

INTERVAL, HALF, COUNT = 0.01, 10, 3000
TEST = bump(HALF, INTERVAL)
TIME = INTERVAL * np.arange(COUNT)


def windows():
    """Return sums of directions, and windows of one direction: the axis turns every second."""
    swing = np.sin(np.pi * TIME + 0.1)
    way = np.where(np.abs(swing) < 0.05, 0.0, np.sign(swing))
    runs = np.concatenate([[0.0], np.cumsum(way)])
    centres = np.arange(HALF, COUNT - HALF, HALF)
    sums = np.abs(runs[centres + HALF + 1] - runs[centres - HALF])
    return runs, centres[sums == 2 * HALF + 1]


def curvature_of(force):
    runs, centres = windows()
    log = even_grid(TIME, {"position": TIME, "force": force})
    return force_curvature(log, TEST, centres, runs)


def test_no_window_is_explained_by_the_errors_of_its_own_force():
    """By the window's own samples the correlation is −0.38; a compliance was named for it."""
    centres = windows()[1]
    correlations = []
    for seed in range(40):
        force = np.random.default_rng(seed).standard_normal(COUNT)
        mean = TEST.over(force, TEST.value, centres)
        correlations.append(np.corrcoef(mean, curvature_of(force))[0, 1])
    assert np.mean(correlations) == pytest.approx(0.0, abs=0.06)


def test_a_cubic_among_errors_has_its_second_derivative_near_a_reversal_too():
    """The errors of 40 logs cancel; by whatever samples, a cubic is exact but for its t⁴."""
    noise = np.random.default_rng(3).standard_normal((40, COUNT))
    centres = windows()[1]
    force = 2 * (TIME - 15) ** 2 + 0.5 * (TIME - 15) ** 3
    mean = np.mean([curvature_of(force + errors) for errors in (*noise, *-noise)], axis=0)
    np.testing.assert_allclose(mean, 4 + 3 * (TIME[centres] - 15), atol=1e-6)


def test_a_force_that_jumps_more_than_its_errors_is_told_by_the_window_itself():
    """A compliance responds to the jump of friction at a reversal, which wider weights miss."""
    rng = np.random.default_rng(5)
    runs, centres = windows()
    force = np.exp(-10 * (TIME % 1.0)) + 1e-4 * rng.standard_normal(COUNT)
    log = even_grid(TIME, {"position": TIME, "force": force})
    wide = np.clip(centres + np.array([[-3 * HALF], [3 * HALF + 1]]), 0, COUNT)
    near = np.abs(runs[wide[1]] - runs[wide[0]]) < 6 * HALF + 1
    assert near.sum() > 50
    own = TEST.over(log.force, TEST.curvature, centres)
    np.testing.assert_allclose(curvature_of(force)[near], own[near])

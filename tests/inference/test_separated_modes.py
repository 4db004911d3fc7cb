"""Modes between which the draws do not move are refused, not guessed at."""

import numpy as np
import pytest
from inference import densities

from bayesfric.inference.evidence.bridge import bridge_evidence
from bayesfric.inference.evidence.importance import importance_draws
from bayesfric.inference.evidence.record import SeparatedModes
from bayesfric.inference.laplace import Laplace

SHAPE = 4, 100, 30  # ensembles, kept, walkers


def draws_of(density, apart, second, seed):
    """Draws of two modes; `second` says which are of the second."""
    size = density.size
    normal = np.random.default_rng(seed).standard_normal((*SHAPE, size))
    return normal + apart * np.broadcast_to(second, SHAPE)[..., None]


@pytest.mark.parametrize("apart", [2.0, 8.0, 1000.0])
def test_each_ensemble_stuck_in_one_mode_is_refused(apart):
    density = densities.two_modes(4, apart)
    stuck = np.array([0, 1, 0, 1])[:, None, None]
    with pytest.raises(SeparatedModes, match=r"R-hat [\d.e+]+ between ensembles"):
        bridge_evidence(density.log_density, draws_of(density, apart, stuck, 1), 1)


def test_a_single_ensemble_elsewhere_is_refused():
    density = densities.two_modes(4, 8.0)
    stuck = np.array([0, 0, 0, 1])[:, None, None]
    with pytest.raises(SeparatedModes):
        bridge_evidence(density.log_density, draws_of(density, 8.0, stuck, 1), 1)


def test_each_walker_stuck_is_refused_though_ensembles_agree():
    """How many walkers a mode has is then a matter of where they started."""
    density = densities.two_modes(4, 8.0, share=0.3)
    stuck = (np.arange(SHAPE[2]) % 2)[None, None, :]
    with pytest.raises(SeparatedModes, match="between walkers"):
        bridge_evidence(density.log_density, draws_of(density, 8.0, stuck, 2), 1)


def test_modes_side_by_side_across_a_ridge_are_refused():
    """They overlap in both coordinates, but not across the ridge."""
    normal = np.random.default_rng(3).standard_normal((*SHAPE, 2))
    along = 10 * normal[..., 0]
    across = 0.1 * normal[..., 1] + np.array([0.5, -0.5, 0.5, -0.5])[:, None, None]
    draws = np.stack([along + across, along - across], axis=-1)
    with pytest.raises(SeparatedModes):
        bridge_evidence(lambda z: -((z[:, 0] - z[:, 1]) ** 2), draws, 1)


@pytest.mark.parametrize("apart", [3.0, 8.0])
def test_draws_that_move_between_modes_are_bridged(apart):
    """Every ensemble and walker sits in both modes, by their true shares."""
    density = densities.two_modes(3, apart, share=0.3)
    moving = np.random.default_rng(4).random(SHAPE) > 0.3
    bridge = bridge_evidence(density.log_density, draws_of(density, apart, moving, 5), 1)
    assert abs(bridge.log_evidence) < 3 * bridge.error
    assert bridge.error < 0.1


def test_no_overlap_is_refused():
    """Modes in many dimensions, too far apart for any one Student-t."""
    density = densities.two_modes(12, 1000.0)
    moving = np.random.default_rng(6).random(SHAPE) > 0.5
    with pytest.raises(SeparatedModes, match=r"overlap by [\d.]+%"):
        bridge_evidence(density.log_density, draws_of(density, 1000.0, moving, 7), 1)


def test_importance_sampling_around_one_mode_of_two_is_unreliable():
    density = densities.two_modes(2, 3.0)
    around_one = Laplace(np.zeros(2), np.eye(2), float(density.log_density(np.zeros((1, 2)))[0]))
    estimate = importance_draws(density.log_density, around_one, 1)
    truth, _ = importance_draws(densities.two_modes(2, 0.0).log_density, around_one, 1)
    # Either the second mode has been seen and counted, or the weights tell of it.
    assert estimate is None or abs(estimate[0].log_evidence - truth.log_evidence) < 3 * np.hypot(
        estimate[0].error, truth.error
    )

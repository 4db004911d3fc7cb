"""Loads that follow a drive, against what can be worked out by hand."""

import numpy as np
import pytest

from bayesfric.physics.loads import behind, on_spring, through_play

INTERVAL, DAMPING = 1e-3, 0.05
TIME = INTERVAL * np.arange(4001)


def test_a_load_coasts_through_play_where_the_drive_is_braked_harder():
    """The drive is braked by 6 m/s², the load by 2: 4 m/s² bring it through a gap of 2 cm."""
    speed = np.clip(3.0 - 6.0 * np.maximum(TIME - 1.0, 0.0), 0.0, 3.0)
    path = np.cumsum(speed) * INTERVAL
    ahead, rubs = (
        motion[:, 0] for motion in through_play(path, INTERVAL, np.array([2.0]), np.array([0.02]))
    )
    assert ahead[900] == pytest.approx(-0.01)  # pushed from behind
    coasting = (ahead > -0.0099) & (ahead < 0.0099)
    assert coasting.sum() * INTERVAL == pytest.approx(np.sqrt(2 * 0.02 / 4.0), abs=4e-3)
    assert ahead[1200] == pytest.approx(0.01)  # it pushes the drive
    assert rubs[1010:1090] == pytest.approx(1.0)
    assert not np.any(rubs[1600:])  # at rest


def test_a_load_that_rubs_harder_than_the_drive_brakes_never_leaves_it():
    path = np.cumsum(np.clip(3.0 - 1.5 * TIME, 0.0, 3.0)) * INTERVAL
    ahead, _ = through_play(path, INTERVAL, np.array([2.0]), np.array([0.02]))
    assert ahead[100:1900] == pytest.approx(-0.01)


def test_a_load_on_a_spring_rings_at_its_frequency_and_rubs():
    pull, slows = 400.0, np.array([0.0, 0.4])
    path = np.where(TIME > 0.1, 0.01, 0.0)
    ahead, _ = on_spring(path, INTERVAL, slows, np.full(2, pull), DAMPING)
    after = TIME - 0.1
    damped = np.sqrt(pull * (1 - DAMPING**2))
    free = -0.01 * np.exp(-DAMPING * 20 * after) * np.cos(damped * after)
    early = (after > 0.02) & (after < 1.0)
    assert ahead[early, 0] == pytest.approx(free[early], abs=8e-4)
    # It sticks within friction over stiffness of where the spring pulls nothing.
    assert np.abs(ahead[-1, 1]) <= 0.4 / pull
    assert np.ptp(ahead[-500:, 1]) < 1e-9
    slow = np.cumsum(np.full(TIME.size, 0.02)) * INTERVAL
    dragged, rubs = on_spring(slow, INTERVAL, slows[1:], np.array([4e5]), DAMPING)
    assert dragged[-1, 0] == pytest.approx(-0.4 / 4e5, rel=0.01)
    assert rubs[-1, 0] == pytest.approx(1.0)


@pytest.mark.parametrize("held", ["play", "spring"])
def test_drives_side_by_side_are_each_as_alone(held):
    springs = np.array([0.5, np.inf]), np.array([0.004, 0.02])
    paths = [0.01 * np.sin(20 * TIME), 0.02 * np.sin(9 * TIME)]
    intervals = np.array([INTERVAL, 3 * INTERVAL])
    together = behind(held, np.stack(paths, axis=1), intervals, 2.0, *springs, DAMPING)
    for place, path in enumerate(paths):
        alone = behind(held, path, intervals[place], 2.0, *springs, DAMPING)
        for batch, other in zip(together, alone, strict=True):
            assert np.ptp(other) > 0
            assert np.array_equal(batch[:, place], other)

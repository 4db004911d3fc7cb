"""Stamps of a host that reads evenly, and stamps that say when each reading was taken."""

import numpy as np
import pytest

from bayesfric.rigs.single_axis.even_clock import even_clock
from bayesfric.rigs.single_axis.even_log import even_grid

INTERVAL = 0.01
NUMBER = np.arange(800)


def swing(time):
    return np.sin(2 * np.pi * 0.6 * time)


def test_stamps_that_jitter_about_even_readings_are_set_right():
    stamps = np.sort(INTERVAL * NUMBER + np.random.default_rng(1).uniform(-4e-3, 4e-3, 800))
    even, off = even_clock(stamps, swing(INTERVAL * NUMBER))
    assert np.abs(even - INTERVAL * NUMBER).max() < 3e-4
    assert off == pytest.approx(8e-3 / 12**0.5, rel=0.1)
    log = even_grid(stamps, {"position": swing(INTERVAL * NUMBER), "force": np.ones(800)})
    assert log.stamps_sd_s == off
    assert np.allclose(log.position, swing(INTERVAL * NUMBER))


@pytest.mark.parametrize("noise", [0.0, 0.002])
def test_readings_that_were_taken_unevenly_keep_their_stamps(noise):
    rng = np.random.default_rng(2)
    taken = np.sort(INTERVAL * NUMBER + rng.uniform(-4e-3, 4e-3, 800))
    stamps, off = even_clock(taken, swing(taken) + noise * rng.standard_normal(800))
    assert stamps is taken
    assert off == 0.0


def test_a_joint_that_stands_still_shows_no_clock():
    stamps = np.sort(INTERVAL * NUMBER + np.random.default_rng(1).uniform(-4e-3, 4e-3, 800))
    kept, off = even_clock(stamps, np.zeros(800))
    assert off == 0.0
    assert np.array_equal(kept, stamps)


def test_jitter_beside_the_counts_of_an_encoder_is_told_apart_from_motion():
    """Positions on the stamps are rougher by half only: that was not enough, and a gear rang."""
    rng = np.random.default_rng(4)
    stamps = INTERVAL * NUMBER + rng.uniform(-5e-4, 5e-4, 800)
    coarse = 1.5e-3 * np.round(swing(INTERVAL * NUMBER) / 1.5e-3)
    even, off = even_clock(stamps, coarse)
    assert np.abs(even - INTERVAL * NUMBER).max() < 1e-4
    assert off == pytest.approx(1e-3 / 12**0.5, rel=0.1)


@pytest.mark.parametrize("jitter", [0.0, 4e-4])
def test_rows_that_are_missing_are_steps_of_several_intervals(jitter):
    """Three rows are missing: a count of the rows would be off by up to an interval and a half."""
    kept = ~np.isin(NUMBER, (100, 101, 350))
    taken = INTERVAL * NUMBER[kept]
    stamps = taken + jitter * np.random.default_rng(6).uniform(-1, 1, taken.size)
    clock, off = even_clock(stamps, swing(taken))
    assert off == pytest.approx(2 * jitter / 12**0.5, rel=0.1)
    np.testing.assert_allclose(clock, taken, atol=5e-5)


def test_a_force_that_was_stamped_with_its_position_gets_the_same_clock():
    """Else a delay between them remains, which is that of the stamps."""
    late = 4e-3 * np.sin(2 * np.pi * NUMBER / 400) ** 2
    stamps = INTERVAL * NUMBER + late + np.random.default_rng(5).uniform(-1e-3, 1e-3, 800)
    columns = {"position": swing(INTERVAL * NUMBER), "force": swing(INTERVAL * NUMBER)}
    for steps in (False, True):
        log = even_grid(stamps, columns, force_time_s=stamps, one_clock=True, steps=steps)
        assert log.stamps_sd_s > 0
        own = even_grid(stamps, columns, steps=steps)
        np.testing.assert_allclose(log.force, own.force, atol=1e-9)

"""Stamps of a host that reads evenly, and stamps that say when each reading was taken."""

import numpy as np
import pytest

from bayesfric.rigs.single_axis.even_log import even_clock, even_grid

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

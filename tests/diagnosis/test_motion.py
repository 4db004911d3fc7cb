"""A trial followed back to its release: motions whose travel is known."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from bayesfric.rigs.gravity_board.measured_motion import travel_to_speed

SPEEDS = np.array([0.02, 0.1, 0.16])


def test_at_a_constant_acceleration_it_is_half_the_square_over_it():
    rates = np.array([0.2, 0.9, 1.2])
    travels = travel_to_speed(SPEEDS, lambda travel, speed: rates[:, None] + 0 * travel)
    np.testing.assert_allclose(travels, SPEEDS**2 / (2 * rates), rtol=1e-12)


def test_where_friction_builds_up_the_energy_is_that_of_the_force_along_the_way():
    """v²/2 = ∫ a dx, with an acceleration that dies out over 5 mm."""

    def rate(travel):
        return 0.4 * (1 + 2 * np.exp(-travel / 5e-3))

    def energy(travel):
        return quad(rate, 0, travel, epsabs=1e-14)[0]

    expected = [brentq(lambda x, v=v: energy(x) - v**2 / 2, 0, 0.1) for v in SPEEDS]
    travels = travel_to_speed(SPEEDS, lambda travel, speed: rate(travel))
    assert travels == pytest.approx(expected, rel=1e-3)


def test_a_force_that_knows_the_speed_is_met_at_that_speed():
    """a = g − k v: x = −v/k − g/k² ln(1 − k v/g)."""
    g, k = 0.5, 1.5
    expected = -SPEEDS / k - g / k**2 * np.log1p(-k * SPEEDS / g)
    travels = travel_to_speed(SPEEDS, lambda travel, speed: g - k * speed)
    np.testing.assert_allclose(travels, expected, rtol=1e-5)

"""Responses that decay geometrically, against filters of another hand and closed forms."""

import numpy as np
import pytest
import scipy

from bayesfric.rigs.single_axis.decay import decaying
from bayesfric.rigs.single_axis.even_log import slope_weights
from bayesfric.rigs.single_axis.force_rates import following


@pytest.mark.parametrize("kept", [0.0, 0.4, 0.95])
def test_a_decay_is_that_of_a_recursive_filter(kept):
    driven = np.random.default_rng(1).standard_normal(500)
    expected = scipy.signal.lfilter([1.0], [1.0, -kept], driven)
    np.testing.assert_allclose(decaying(driven, kept), expected, atol=1e-12)


def test_what_was_there_before_decays():
    np.testing.assert_allclose(decaying(np.zeros(4), 0.5, 8.0), [4.0, 2.0, 1.0, 0.5])


def test_a_lag_follows_a_ramp_by_its_time_constant_and_starts_at_rest():
    ramp = np.arange(200.0)
    lagging = following(ramp, 5.0)
    assert lagging[0] == 0.0
    np.testing.assert_allclose(ramp[150:] - lagging[150:], 5.0, rtol=1e-12)
    np.testing.assert_allclose(following(np.full(9, 3.0), 5.0), 3.0)


def test_slope_weights_are_those_of_a_savitzky_golay_filter():
    expected = scipy.signal.savgol_coeffs(15, 3, deriv=1)[::-1]
    np.testing.assert_allclose(slope_weights(7, 3), expected, atol=1e-15)

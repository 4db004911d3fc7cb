"""What counts as a swing, of errors that are given."""

import numpy as np
import pytest

from bayesfric.margins.swing import Swing

LENGTH = 400


def hunts(error):
    """Judge one error over a whole run; what counts as still is 1, a swing keeps 0.6."""
    length = np.array([LENGTH])
    swing = Swing(length, np.array([1e-3]), np.array([1.0]), np.array([0.6]))
    for k in range(1, LENGTH + 1):
        against = np.array([error[k - 1] - error[k]])  # the shaft's speed beyond the reference's
        swing.see(np.array([k]), np.array([error[k]]), against, np.array([True]))
    return bool(swing.judged(error, error).hunts[0])


@pytest.mark.parametrize(
    ("name", "expected"),
    [("swing", True), ("jitter", False), ("follows", False), ("breaks away", False)],
)
def test_a_swing_goes_out_and_back(name, expected):
    k = np.arange(LENGTH + 1)
    jitter = 0.2 * (-1.0) ** k
    error = {
        "swing": 5 * np.sin(2 * np.pi * k / 40),
        "jitter": jitter,
        "follows": jitter + 0.05 * k,
        # stands while the reference moves on, then is dragged behind it
        "breaks away": np.where((k > 310) & (k < 330), 0.7 * (k - 310), 14.0 * (k >= 330)) + jitter
        * ((k <= 310) | (k >= 330)),
    }[name]  # fmt: skip
    assert hunts(error) is expected

"""What scatters of the intercept, of laws in the three cases that there are."""

import numpy as np
import pytest

from bayesfric.observation.coefficients import intercept_of
from bayesfric.physics.friction import Coefficients


@pytest.mark.parametrize(
    ("c1", "c2", "expected"),
    [
        (0.004, 0.0165, 0.0165),  # c2, where it is a fifth of the 0.0765 N of a pulley at 15 N
        (0.004, 0.001, 0.0061),  # a tenth of 0.061 N, where an effect has taken c2 to nothing
        (0.004, 0.0, 0.0),  # a law without c2
    ],
)
def test_it_is_c2_or_a_tenth_of_friction(c1, c2, expected):
    law = Coefficients(np.array([c1]), np.array([c2]), np.array([0.0]))
    assert intercept_of(law) == pytest.approx([expected])

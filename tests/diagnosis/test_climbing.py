"""A climb to the mode of the noise, of a log density whose mode is known."""

from dataclasses import dataclass

import numpy as np

from bayesfric.diagnosis.acting import Acting, At
from bayesfric.diagnosis.climbing import climb

CURVATURE = np.array([10.0, 40.0, 90.0])
PULL = np.array([30.0, -50.0, 70.0])  # of the number at its end, on the others
SLOPE = 200.0  # of the log density towards that end
MOST = 15  # evaluations


@dataclass
class Noise:
    bounds: tuple[float, float] = (1e-6, 1e6)


class Tilted:
    """Normal in three numbers, and the larger the more there is of a fourth, which has an end."""

    noise = (Noise(), Noise(), Noise(), Noise((1e-6, np.e)))

    def __init__(self, steeper=1.0):
        self.curvature = steeper * CURVATURE
        self.calls = 0
        self.values_with_slopes = []

    def evaluate(self, psi, acting, wide, form, *, gradient=False, above=-np.inf):
        self.calls += 1
        free, end = psi[:3], psi[3]
        value = -0.5 * self.curvature @ free**2 + end * (PULL @ free + SLOPE)
        if not value > above:
            return At(psi, value, None, None, None, None)
        slope = np.append(end * PULL - self.curvature * free, PULL @ free + SLOPE)
        self.values_with_slopes.append(value)
        return At(psi, value, slope, None, None, None)

    def reweighted(self, psi, acting, wide=None, form=None):
        """Its scatter is normal."""
        return self


def test_a_number_at_the_end_of_its_range_spoils_no_step_of_the_others():
    """Its slope changes with the others, which is no curvature of theirs."""
    model = Tilted()
    at = climb(model, np.array([0.0, 0.0, 0.0, 0.5]), Acting())
    assert at.at_mode
    assert at.psi[3] == 1.0
    short = at.psi[:3] - PULL / CURVATURE
    assert 0.5 * CURVATURE @ short**2 < 0.1  # nat below the mode
    assert model.calls <= MOST


def test_no_derivatives_are_made_of_a_step_that_gains_nothing():
    model = Tilted(steeper=100.0)
    climb(model, np.array([0.0, 0.0, 0.0, 0.5]), Acting())
    assert np.all(np.diff(model.values_with_slopes) > 0)
    assert len(model.values_with_slopes) < model.calls

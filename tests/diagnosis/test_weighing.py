"""The evidence of amplitudes that act together, against its integral."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import dblquad
from scipy.stats import halfnorm, norm

from bayesfric.analysis import Analysis, HalfNormal, Normal
from bayesfric.diagnosis.linear_model import LinearModel
from bayesfric.diagnosis.weighing import combine, weigh
from bayesfric.diagnosis.which import _other_choices, _rough_pair, _rough_pairs
from bayesfric.effects import all_effects
from bayesfric.effects.candidates import candidates_of
from bayesfric.fitting.hypothesis import Data
from bayesfric.inference.information import Reduced
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import simulate_recording, table1_coefficients

SMALL = Protocol({(9, 85.0): 2, (15, 50.0): 1}, (6.0, 28.0), (6.0, 28.0), 2)
PRECISION = np.array([[3.0, 1.2, -0.4], [1.2, 2.0, 0.7], [-0.4, 0.7, 5.0]])
SLOPE = np.array([0.8, -1.5, 2.0])
REDUCED = Reduced(PRECISION, SLOPE, -7.0)


def candidate(prior):
    return SimpleNamespace(effect=SimpleNamespace(amplitude=SimpleNamespace(prior=prior)))


# The first is held above zero; amplitudes are in units of their priors.
MODEL = SimpleNamespace(
    candidates=[candidate(HalfNormal(scale=1.0))] + 2 * [candidate(Normal(mean=0.0, sd=1.0))]
)


def integral(first, second):
    """Return the log evidence of two amplitudes by quadrature."""
    place = [first, second]
    precision, slope = PRECISION[np.ix_(place, place)], SLOPE[place]
    prior = halfnorm if first == 0 else norm

    def density(b, a):
        amplitudes = np.array([a, b])
        exponent = slope @ amplitudes - 0.5 * amplitudes @ precision @ amplitudes
        return np.exp(exponent) * prior.pdf(a) * norm.pdf(b)

    return -7.0 + np.log(dblquad(density, 0 if first == 0 else -8, 8, -8, 8)[0])


def test_each_choice_is_the_integral_over_its_amplitudes():
    pairs = np.array([[0, 1], [0, 2], [1, 2]])
    expected = [integral(*pair) for pair in pairs]
    np.testing.assert_allclose(combine(MODEL, REDUCED, pairs, pairs), expected, atol=1e-6)


def test_none_that_acts_leaves_the_evidence():
    nothing = np.empty((1, 0), dtype=np.intp)
    assert combine(MODEL, REDUCED, nothing, nothing) == pytest.approx([-7.0])


def test_pairs_are_weighed_in_one_call_as_each_alone():
    recording = simulate_recording(SMALL, seed=5, effects={"wear-drift": 1.0})
    data = Data(recording.rig, recording.gravity, recording.motor)
    effects = ["mass-error", "tension-curvature", "wear-drift"]
    candidates = [one for name in effects for one in candidates_of(all_effects()[name])]
    model = LinearModel(data, table1_coefficients(), candidates, Analysis(), 0.005)
    psi = model.start
    singles = {name: weigh(model, (name,), psi, climb=False) for name in effects}
    for (a, b), value in _rough_pairs(model, singles, effects, psi).items():
        expected = _rough_pair(model, singles[a], singles[b], psi)
        expected += sum(_other_choices(model, singles[name]) for name in (a, b))
        assert value == pytest.approx(expected, abs=1e-6), (a, b)

"""The force that each effect makes lies, by its shares, along an axis of the effect's.

No diagnosis is asked: forces are those of the effects' own laws, once a law is refitted.
"""

import numpy as np
import pytest
from diagnosis.boards import data_of
from diagnosis.driven_axis import model_of_axis

from bayesfric.analysis import Analysis
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.residuals import residuals_of
from bayesfric.diagnosis.shares import shares_of
from bayesfric.effects import all_effects
from bayesfric.effects.candidates import candidates_of
from bayesfric.rigs.protocols import PROTOCOLS
from bayesfric.simulate import simulate_recording, table1_coefficients

RINGING = "cable-compliance"  # in less time than a window takes
NAMES = sorted(n for n, e in all_effects().items() if not e.components and n != RINGING)
OF_AN_AXIS = (
    *("air-drag", "backlash", "direction-asymmetry", "hysteresis", "presliding"),
    *("delay", "actuator-lag", "spring", "stribeck", "wear-drift"),
)
"""Those whose force windows of a driven axis show: no wave, no ringing, and what no law takes."""


def middle(effect):
    """Return one candidate of each law of an effect, with its shape in the middle."""
    by_law = {}
    for candidate in candidates_of(effect):
        by_law.setdefault(candidate.law, []).append(candidate)
    return [laws[len(laws) // 2] for laws in by_law.values()]


def forces_in(model, psi):
    """Return windows, and what each effect's laws do in them that no law takes, by name."""
    residuals = residuals_of(model, psi)
    start = model.layout.own
    columns = residuals.columns[:, start : start + len(model.candidates)]
    owner = np.array([candidate.effect.name for candidate in model.candidates])
    return residuals, {
        name: residuals.without_law(columns[:, owner == name]) for name in np.unique(owner)
    }


def is_along_its_own(residuals, forces, name):
    """Assert that the largest share of the force of each law is that of an axis of the effect."""
    shares = shares_of(residuals, forces[name], {})
    for law in range(forces[name].shape[1]):
        first = max(shares.share, key=lambda axis: shares.share[axis][law])
        assert first in all_effects(None)[name].axes, law


@pytest.fixture(scope="module")
def board():
    candidates = [candidate for name in NAMES for candidate in middle(all_effects()[name])]
    recording = simulate_recording(PROTOCOLS["quick"], seed=5, rigs=("gravity", "motor"))
    model = LinearModel(data_of(recording), table1_coefficients(), candidates, Analysis())
    return forces_in(model, model.noise.start)


@pytest.fixture(scope="module")
def axis(driven_axis):
    return forces_in(*model_of_axis(driven_axis, middle))


@pytest.mark.parametrize("name", NAMES)
def test_on_a_board_the_first_axis_is_one_of_the_effects_own(board, name):
    is_along_its_own(*board, name)


@pytest.mark.parametrize("name", OF_AN_AXIS)
def test_on_a_driven_axis_the_first_axis_is_one_of_the_effects_own(axis, name):
    is_along_its_own(*axis, name)

"""The force that each effect makes on a board lies, by its shares, along an axis of the effect's.

No diagnosis is asked: forces are those of the effects' own laws, once a law is refitted.
"""

import numpy as np
import pytest
from diagnosis.boards import data_of

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


def middle(name):
    """Return one candidate of each law of an effect, with its shape in the middle."""
    by_law = {}
    for candidate in candidates_of(all_effects()[name]):
        by_law.setdefault(candidate.law, []).append(candidate)
    return [each[len(each) // 2] for each in by_law.values()]


@pytest.fixture(scope="module")
def board():
    """Return windows of a board, and the force of each effect's laws in them, by name."""
    candidates = [one for name in NAMES for one in middle(name)]
    recording = simulate_recording(PROTOCOLS["quick"], seed=5, rigs=("gravity", "motor"))
    model = LinearModel(data_of(recording), table1_coefficients(), candidates, Analysis())
    residuals = residuals_of(model, model.noise.start)
    columns = residuals.columns[:, model.layout.own : model.layout.own + len(candidates)]
    owner = np.array([one.effect.name for one in candidates])
    return residuals, {name: residuals.without_law(columns[:, owner == name]) for name in NAMES}


@pytest.mark.parametrize("name", NAMES)
def test_the_first_axis_is_one_of_the_effects_own(board, name):
    residuals, forces = board
    found = shares_of(residuals, forces[name], {})
    for law in range(forces[name].shape[1]):
        first = max(found.share, key=lambda axis: found.share[axis][law])
        assert first in all_effects()[name].axes, law

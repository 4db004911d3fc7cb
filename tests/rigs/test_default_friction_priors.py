"""The default priors of friction describe boards that an experimenter would have built."""

import numpy as np
import pytest

from bayesfric.analysis import Analysis
from bayesfric.inference.model import Model
from bayesfric.observation.coefficients import coefficient_parameters, law_of
from bayesfric.physics.friction import coulomb_friction
from bayesfric.recording.tables import STANDARD_GRAVITY
from bayesfric.rigs.protocols import PROTOCOLS

DRAWS = 4000
WRAPS_DEG = np.linspace(15.0, 165.0, 7)  # of the paper's Table II, with room to spare
TENSIONS_N = np.array([5.0, 30.0])


@pytest.fixture(scope="module")
def drawn():
    model = Model([], coefficient_parameters(("small",), Analysis()))
    theta = model.draw_prior(DRAWS, np.random.default_rng(1))
    return law_of(model.by_name(theta), "small")


def test_friction_is_positive_at_any_wrap_angle(drawn):
    for wrap in WRAPS_DEG:
        for tension in TENSIONS_N:
            friction = coulomb_friction(drawn, 1, wrap, tension)
            assert (friction > 0).mean() >= 0.99, (wrap, tension)


@pytest.mark.parametrize("protocol", sorted(PROTOCOLS))
def test_boards_move_in_three_quarters_of_draws_and_conditions(drawn, protocol):
    moves = []
    for assembly in PROTOCOLS[protocol].assemblies():
        for trial in assembly.trials:
            tension = (trial.mass_drive_kg + trial.mass_load_kg) / 2 * STANDARD_GRAVITY
            drive = (trial.mass_drive_kg - trial.mass_load_kg) * STANDARD_GRAVITY
            friction = coulomb_friction(drawn, assembly.n_pulleys, assembly.wrap_angle_deg, tension)
            moves.append((friction < drive).mean())
    assert np.mean(moves) >= 0.75

"""A fitted law is linearised around where friction is still of the size that it was."""

import numpy as np
import pytest
from rigs.friction_points import recorded, slide

from bayesfric.analysis import Analysis
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.nearby import around_nearby
from bayesfric.physics.friction import Coefficients
from bayesfric.rigs import all_rigs
from bayesfric.rigs.data import Data
from bayesfric.rigs.opening import with_own_priors


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    recording = recorded(tmp_path_factory.mktemp("slide"), slide())
    trials = all_rigs()["steady-points"].trials(recording)
    size = trials.table["pulley_size"].iloc[0]
    analysis = with_own_priors(Analysis(), (trials,))
    law = {size: Coefficients(0.1, 10.0, 0.0)}
    return LinearModel(Data((trials,)), law, [], analysis, discrepancy=False)


@pytest.mark.parametrize(
    ("fitted", "share"),
    [
        ((0.08, 12.0), 1.0),
        ((0.04, 4.0), 0.5),  # two fifths of friction
        ((0.001, 0.1), 0.25),  # a hundredth
        ((0.28, 28.0), 0.25),  # nearly three times as much
        ((-0.5, -50.0), 0.0),
    ],
)
def test_the_law_is_gone_towards_as_far_as_friction_keeps_its_size(model, fitted, share):
    ((size, law),) = model.laws.items()
    found = around_nearby(
        model, {size: Coefficients(*fitted, 0.0)}, [], scattering=(), forms=()
    ).laws[size]
    for value, before, after in zip(found, law, (*fitted, 0.0), strict=True):
        assert value == pytest.approx(before + share * (after - before))
    assert np.all(np.isfinite(found))

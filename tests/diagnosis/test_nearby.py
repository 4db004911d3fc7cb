"""A fitted law is linearised around where friction is still of the size that it was."""

import numpy as np
import pytest
from rigs.friction_points import recorded, slide

from bayesfric.analysis import Analysis
from bayesfric.diagnosis import diagnose
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
    around, is_last_step = around_nearby(
        model, {size: Coefficients(*fitted, 0.0)}, [], scattering=(), forms=()
    )
    law_around = around.laws[size]
    assert is_last_step is (share in (0.0, 1.0))
    for value, before, after in zip(law_around, law, (*fitted, 0.0), strict=True):
        assert value == pytest.approx(before + share * (after - before))
    assert np.all(np.isfinite(law_around))


@pytest.mark.parametrize("slope", [0.6, 1.0])
def test_a_large_viscous_friction_is_a_share_of_the_law_without_it(tmp_path, slope):
    """The law without it has up to three times the friction, and only half of the way was gone."""
    rng = np.random.default_rng(1)
    tension, speed = np.tile([5.0, 10.0, 15.0, 20.0], 15), np.repeat(np.linspace(0.05, 1.3, 15), 4)
    friction = 5 * (0.0042 * tension + 0.0165) * (1 + 0.01 * rng.standard_normal(60))
    friction += 5 * slope * speed * (0.0042 * 15 + 0.0165) + 0.002 * rng.standard_normal(60)
    table = {
        "velocity_m_s": speed,
        "tension_n": tension,
        "friction_n": friction,
        "pulley_size": ["medium"] * 60,
        "n_pulleys": [5] * 60,
        "wrap_angle_deg": [85.0] * 60,
    }
    (cause,) = diagnose(recorded(tmp_path / "points", table)).summary.causes
    assert cause.effect == "viscous"
    assert cause.parameters["slope"].q50 == pytest.approx(slope, rel=0.02)

"""The discrepancy of every hypothesis: its units, how it grows, what it does not hide."""

import numpy as np
import pytest

from bayesfric.analysis import Analysis, HalfNormal
from bayesfric.diagnosis.diagnosing import diagnose
from bayesfric.diagnosis.linear_model import LinearModel
from bayesfric.diagnosis.shapes import sharpened_around
from bayesfric.diagnosis.weighing import weigh
from bayesfric.diagnosis.which import look_closer, which_effect
from bayesfric.effects import Effect, EffectParameter, all_effects
from bayesfric.effects.candidates import candidates_of
from bayesfric.fitting.hypothesis import Data
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import AppliedEffect, Truth, simulate_recording, table1_coefficients

SMALL = Protocol({(9, 85.0): 2, (15, 50.0): 1}, (6.0, 28.0), (6.0, 28.0), 2)
SHARE = 0.005


@pytest.fixture(scope="module")
def model():
    """Viscous friction of a tenth of friction is there; runout may be."""
    recording = simulate_recording(SMALL, seed=5, effects={"viscous": 1.0})
    data = Data(recording.rig, recording.gravity, recording.motor)
    effects = [all_effects()[name] for name in ("viscous", "runout")]
    candidates = [one for effect in effects for one in candidates_of(effect)]
    return LinearModel(data, table1_coefficients(), candidates, Analysis(), SHARE)


def test_a_relative_force_is_a_share_of_friction(model):
    (place,) = (k for k, s in enumerate(model.smooths) if s.relative and s.axis == "n_pulleys")
    smooth = model.smooths[place]
    rows, motor = model.gravity.rows, model.motor
    start = 3 + sum(s.count for s in model.smooths[:place])
    shape = smooth.columns({"n_pulleys": rows.trials["n_pulleys"].to_numpy(dtype=float)[:, None]})
    for k in range(smooth.count):
        expected = rows.forces(rows.friction_n[:, None] * shape[k])
        scale = model.scale(start + k)
        np.testing.assert_allclose(model.gravity.columns[:, start + k], scale * expected)
    shape = smooth.columns({"n_pulleys": motor.trials["n_pulleys"].to_numpy(dtype=float)})
    expected = model.scale(start) * shape[0] * motor._amperes(motor.friction_n)
    np.testing.assert_allclose(motor.columns[:, start], expected)


def test_a_constant_of_the_motor_board_is_a_share_of_friction(model):
    (place,) = (k for k, s in enumerate(model.smooths) if not s.axes)
    column = 3 + sum(s.count for s in model.smooths[:place])
    motor, scale = model.motor, model.scale(column)
    assert (model.smooths[place].count, model.smooths[place].axis) == (1, "rig")
    np.testing.assert_allclose(motor.columns[:, column], scale * motor._amperes(motor.friction_n))
    np.testing.assert_array_equal(model.gravity.columns[:, column], 0.0)


def test_it_grows_by_a_tenth_of_what_the_effects_do(model):
    """A tenth of friction, and a tenth of that beside the practical share: √(0.5² + 1²) %."""
    found = weigh(model, ("viscous",), model.start)
    wider = sharpened_around(model, found)
    assert wider.practical_share == pytest.approx(np.hypot(SHARE, 0.01), rel=0.1)
    ratio = wider.practical_share / SHARE
    forces = slice(3, model.layout.own)
    np.testing.assert_allclose(
        wider.prior(())[1][forces], ratio * model.prior(())[1][forces], rtol=1e-12
    )
    amounts = wider.small[: len(model.small)]  # forms come after them
    for (_, sd), (_, before) in zip(amounts, model.small, strict=True):
        assert sd == pytest.approx(ratio * before, rel=1e-12)


def test_neighbours_are_compared_among_themselves(model):
    """The leading hypothesis is as probable beside all others as before it was looked at."""
    which = which_effect(model, model.start)
    found = which.weighed["viscous"]
    closer = look_closer(sharpened_around(model, found), which, found)
    assert closer.log_evidence["viscous"] == pytest.approx(which.log_evidence["viscous"])
    assert closer.log_evidence["none"] == which.log_evidence["none"]
    gained = closer.log_evidence["runout+viscous"] - closer.log_evidence["viscous"]
    again = closer.weighed
    assert gained == pytest.approx(
        again["runout+viscous"].log_evidence - again["viscous"].log_evidence
    )


def test_an_effect_acts_on_top_of_its_small_amount(model):
    """Phases of variance a² and s² together are phases of variance a² + s²."""
    place = next(p for p, c in enumerate(model.candidates) if c.effect.name == "runout")
    without = LinearModel(
        model.data,
        model.laws,
        model.candidates,
        Analysis(),
        SHARE,
        small=[one for one in model.small if one[0].effect.name != "runout"],
    )
    (amount,) = (sd for one, sd in model.small if one.effect.name == "runout")
    noise, kept = model.noise(model.start)[0], np.arange(3)
    together = [(without.gravity.blocks[place], float(np.hypot(0.05, amount)))]
    expected = without.gravity.information(noise, kept, together)
    found = model.gravity.information(noise, kept, [(model.gravity.blocks[place], 0.05)])
    assert found.constant == pytest.approx(expected.constant, rel=1e-12)
    np.testing.assert_allclose(found.precision, expected.precision, rtol=1e-9)


@pytest.mark.parametrize(
    ("share", "law", "axis"),
    [
        # One number of pulleys rubs 14 % more: four times the scatter of assemblies, or a force.
        (0.14, lambda s: np.asarray(s.n_pulleys) == 9, "n_pulleys"),
        # All that the motor drives rubs 10 % more, which no law of friction tells apart.
        (0.10, lambda s: s.steady, "rig"),
    ],
)
def test_what_scatter_hides_is_looked_for_without_it(share, law, axis):
    effect = Effect(
        name="somewhere",
        acts_on="friction",
        sentence="friction is higher somewhere",
        amplitude=EffectParameter(
            name="share",
            unit="1",
            meaning="of friction",
            prior=HalfNormal(scale=0.5),
            plausible=(0.0, 1.0),
            reference="made up",
        ),
        laws={"there": lambda p, s: p["share"] * s.friction_n * law(s)},
    )
    truth = Truth(effects=(AppliedEffect(effect, "there", {"share": share}),))
    found = diagnose(simulate_recording("quick", seed=11, truth=truth)).summary
    assert found.verdict == "unknown"
    assert found.remainder.axis == axis

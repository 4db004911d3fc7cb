"""Draws of what a hypothesis leaves open against the closed form where sizes are known."""

import numpy as np
import pytest
from diagnosis.boards import SMALL, data_of

from bayesfric.analysis import Analysis
from bayesfric.diagnosis import left_open
from bayesfric.diagnosis.acting import Acting
from bayesfric.diagnosis.climbing import climb, curvature_at
from bayesfric.diagnosis.forms import FormShare, other_forms
from bayesfric.diagnosis.left_open import drawn_numbers
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.squeezing import squeezed
from bayesfric.diagnosis.weighing import weigh
from bayesfric.effects import all_effects
from bayesfric.effects.candidates import candidates_of
from bayesfric.rigs.truth import AppliedEffect, Truth
from bayesfric.simulate import simulate_recording, table1_coefficients

DRAWS = 4000


@pytest.fixture(scope="module")
def weighed():
    """A model with forms of viscous friction, which acts, and the hypothesis of it."""
    effect = all_effects()["viscous"]
    (law, *_) = effect.laws
    truth = Truth(effects=[AppliedEffect(effect, law, {effect.amplitude.name: 0.1})])
    recording = simulate_recording(SMALL, seed=5, rigs=("gravity",), truth=truth)
    candidates = [
        candidate
        for name in ("end-asymmetry", "viscous")
        for candidate in candidates_of(all_effects()[name])
    ]
    first = LinearModel(data_of(recording), table1_coefficients(), candidates, Analysis())
    at = climb(first, first.noise.start, Acting())
    inverse = np.linalg.inv(curvature_at(first, at, Acting()))
    viscous = weigh(first, ("viscous",), [at.psi], inverse, 0.0)
    acting = first.amplitudes(viscous.at, viscous.acting)
    forms = other_forms([rig.rows for rig in first.rigs], acting)
    model = squeezed(first.around(first.laws, candidates, forms=forms), viscous.at.psi)
    return model, weigh(model, ("viscous",), [viscous.at.psi], inverse, 0.0)


@pytest.mark.parametrize("whole", [False, True], ids=["squeezed", "whole"])
@pytest.mark.parametrize(("size", "share"), [(1.0, 0.3), (0.3, 0.0)])
def test_with_sizes_that_are_known_draws_are_normal_by_the_closed_form(
    weighed, monkeypatch, whole, size, share
):
    """Of the numbers of all sizes of pulleys, effects, forms and nuisances together."""
    model, hypothesis = weighed
    model = model.full if whole else model
    monkeypatch.setattr(left_open, "SIZES", np.array([size]))
    monkeypatch.setattr(left_open, "SHARES", (share,))
    drawn = drawn_numbers(model, hypothesis, DRAWS, np.random.default_rng(1))
    information = model.evaluate(hypothesis.at.psi, hypothesis.acting).information
    priors = [model.amplitude_prior(law) for law in hypothesis.acting.laws]
    prior = model.prior(priors, None, {"viscous": FormShare(share)}, discrepancy=size)
    _, mean, covariance = information.integrated(*prior)
    sd = np.sqrt(np.diag(covariance))
    free = sd > 0
    off = (drawn.mean(axis=0) - mean)[free] / sd[free]
    np.testing.assert_allclose(drawn[:, ~free], np.tile(mean[~free], (DRAWS, 1)), atol=1e-12)
    assert np.abs(off).max() < 5 / np.sqrt(DRAWS)
    np.testing.assert_allclose(drawn.std(axis=0)[free], sd[free], rtol=0.06)
    # What hangs together does so in the draws: the law with what takes its place.
    along = covariance[:, 0] / sd[0]
    np.testing.assert_allclose(
        np.cov(drawn.T)[:, 0] / sd[0], along, atol=5 * sd.max() / np.sqrt(DRAWS)
    )


def test_each_axis_and_each_amount_is_a_group_of_its_own(weighed):
    """Every number is in one, and forms apart by the axis that they change along."""
    model, _ = weighed
    mixing, groups = left_open._groups(model)
    places = np.concatenate([group.places for group in groups])
    np.testing.assert_array_equal(np.sort(places), np.arange(mixing.shape[1]))
    axes = {smooth.axis for smooth in model.full.discrepancy.smooths}
    amounts = {candidate.effect.name for candidate, _ in model.full.discrepancy.amounts}
    forms = {form.axis for form in model.forms}
    assert {"speed_m_s", "tension_n", "order"} <= forms
    assert len(groups) == len(axes) + len(amounts) + len(forms)
    assert [group.sizes[0] for group in groups[-len(forms) :]] == [0.0] * len(forms)

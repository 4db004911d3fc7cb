"""Priors of effects are the user's, and reach what is computed with them."""

import numpy as np
import pytest

from bayesfric.analysis import Analysis, HalfNormal, Priors, read_analysis
from bayesfric.claims import check_claims, checking
from bayesfric.claims.entered import Entered
from bayesfric.claims.studies import Studied, Task, study_all
from bayesfric.effects import all_effects, with_priors
from bayesfric.errors import InputError
from bayesfric.fitting import fit
from bayesfric.fitting.hypothesis import LawWithEffects
from bayesfric.simulate import simulate_recording


def test_a_prior_of_the_analysis_takes_the_place_of_the_effect_s(tmp_path):
    file = tmp_path / "analysis.toml"
    file.write_text('[priors.effects.viscous]\nslope = { family = "half-normal", scale = 0.3 }\n')
    effects = with_priors(all_effects(), read_analysis(file).priors.effects)
    assert effects["viscous"].amplitude.prior == HalfNormal(scale=0.3)
    assert {n for n in effects if effects[n] != all_effects()[n]} == {"viscous"}
    assert with_priors(all_effects(), {}) == all_effects()


def test_a_shape_s_prior_leaves_the_amplitude_s():
    shape = all_effects()["stribeck"].shape
    wide = HalfNormal(scale=1.0)
    stribeck = with_priors(all_effects(), {"stribeck": {shape.name: wide}})["stribeck"]
    assert stribeck.shape.prior == wide
    assert stribeck.amplitude == all_effects()["stribeck"].amplitude


@pytest.mark.parametrize(
    "priors", [{"visc": {"slope": HalfNormal(scale=1.0)}}, {"viscous": {"c": HalfNormal(scale=1)}}]
)
def test_what_no_effect_has_is_refused(priors):
    with pytest.raises(InputError, match=r"visc.*(such as .*viscous|one of slope)"):
        with_priors(all_effects(), priors)


def test_priors_of_another_rig_s_effects_are_no_fault():
    priors = {"backlash": {"share": HalfNormal(scale=1.0)}}
    assert with_priors(all_effects(), priors) == all_effects()


def test_a_fit_refuses_priors_of_what_is_no_effect(tmp_path):
    file = tmp_path / "analysis.toml"
    file.write_text('[priors.effects.stribek]\nrise = { family = "half-normal", scale = 1 }\n')
    with pytest.raises(InputError, match="such as stribeck"):
        fit(None, read_analysis(file))  # before the recording is looked at


def test_a_prior_ten_times_wider_favours_the_claim_by_a_factor_of_ten():
    """Data that leave no room for the effect pay the Occam factor alone."""
    entered = Entered.of(simulate_recording("quick", seed=4, rigs=("gravity",)))
    prior = all_effects()["viscous"].amplitude.prior
    wide = {"viscous": {"slope": HalfNormal(scale=10 * prior.scale)}}
    task = Task("gravity/small", LawWithEffects(effects=(("viscous", "constant"),)))
    narrow, broad = (
        study_all([task], entered.data, Analysis(), effects, None)[task].evidence
        for effects in (all_effects(), with_priors(all_effects(), wide))
    )
    error = np.hypot(narrow.error, broad.error)
    change = narrow.log_evidence - broad.log_evidence
    assert change == pytest.approx(np.log(10), abs=4 * error + 0.02)


def test_claims_take_the_priors_of_the_analysis(monkeypatch):
    taken = {}

    def study(tasks, data, analysis, effects, executor, **more):
        taken.update(effects)
        return dict.fromkeys(tasks, Studied(None))

    monkeypatch.setattr(checking, "study_all", study)
    recording = simulate_recording("quick", seed=4, rigs=("motor",))
    mine = {"viscous": {"slope": HalfNormal(scale=3.0)}}
    check_claims(recording, Analysis(priors=Priors(effects=mine)), only=["no-viscous-motor"])
    assert taken["viscous"].amplitude.prior == HalfNormal(scale=3.0)

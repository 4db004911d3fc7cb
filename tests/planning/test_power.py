"""What a design can tell, against the exact likelihood of recordings that were made by it."""

import numpy as np
import pytest
from rigs.friction_points import joint, recorded
from typer.testing import CliRunner

from bayesfric.analysis import Analysis, LogNormal, Priors
from bayesfric.cli import app
from bayesfric.effects import all_effects
from bayesfric.errors import InputError
from bayesfric.fitting.hypothesis import Hypothesis, model_of
from bayesfric.inference.laplace import laplace_approximation
from bayesfric.inference.power import log_bayes_factor
from bayesfric.planning import power
from bayesfric.recording import write_recording
from bayesfric.rigs.data import Data
from bayesfric.rigs.opening import open_rigs
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import AppliedEffect, Truth, simulate_recording

DESIGN = Protocol({(9, 85.0): 2, (15, 50.0): 1, (5, 135.0): 1}, (6.0, 28.0), (6.0, 28.0), 2)
USUAL = {"tau": 0.01, "omega": 0.015, "omega_intercept": 0.015, "wander": 0.001}
KNOWN = Priors(
    **{name: LogNormal(median=value, sd_log=0.01) for name, value in USUAL.items()},
    wander_length=LogNormal(median=0.1, sd_log=0.01),
    sigma_x=LogNormal(median=3e-5, sd_log=0.01),
    sigma_t=LogNormal(median=1e-6, sd_log=0.01),
)
ANALYSIS = Analysis(priors=KNOWN)
VISCOUS = ("viscous", "constant")


def made(seed, slope=0.0):
    effects = all_effects(None)
    acting = (AppliedEffect(effects["viscous"], "constant", {"slope": slope}),) if slope else ()
    truth = Truth(**USUAL, sigma_x=3e-5, sigma_t=1e-6, effects=acting)
    return simulate_recording(DESIGN, seed=seed, truth=truth, rigs=("gravity",))


def known_of(recording, effects=()):
    """Return mode and sd of each parameter by the exact likelihood, in their units."""
    data = Data(open_rigs(recording, ["gravity"]))
    model = model_of(data, ANALYSIS, Hypothesis(effects=effects), all_effects(None))
    laplace = laplace_approximation(model.log_posterior, model.start(), model.scale())
    step = 1e-3 * np.sqrt(np.diag(laplace.covariance))
    ends = model.natural(laplace.mode + np.array([-1.0, 1.0])[:, None, None] * np.diag(step))
    slope = np.diagonal(ends[1] - ends[0]) / (2 * step)
    mode = model.natural(laplace.mode[None])[0]
    sd = slope * np.sqrt(np.diag(laplace.covariance))
    return dict(zip(model.names, zip(mode, sd, strict=True), strict=True))


@pytest.fixture(scope="module")
def plan():
    return power(made(1), ANALYSIS)


def test_coefficients_are_known_as_well_as_the_exact_likelihood_knows_them(plan):
    found = known_of(made(2))
    for name, row in plan.coefficients.iterrows():
        assert row["sd"] == pytest.approx(found[name][1], rel=0.15), name
    assert plan.coefficients["informed"].all()


def test_what_was_measured_does_not_enter(plan):
    """The same trials on a board with another friction: one answer."""
    again = power(made(1, slope=0.02), ANALYSIS)
    np.testing.assert_allclose(plan.coefficients["sd"], again.coefficients["sd"], rtol=1e-6)
    np.testing.assert_allclose(plan.effects["smallest"], again.effects["smallest"], rtol=1e-6)


def test_the_error_of_an_amplitude_is_that_of_the_exact_likelihood(plan):
    smallest = plan.effects.loc["viscous/constant", "smallest"]
    prior = all_effects(None)["viscous"].amplitude.prior
    mode, sd = known_of(made(3, slope=smallest), (VISCOUS,))["viscous.slope"]
    assert abs(mode - smallest) < 4 * sd
    # At the threshold's estimate, 1.28 errors below: the odds that support asks for.
    odds = ANALYSIS.claims.support_log10_bayes_factor * np.log(10)
    assert log_bayes_factor(smallest - 1.2816 * sd, sd, prior) == pytest.approx(odds, abs=0.7)


@pytest.mark.nightly
def test_an_effect_of_that_size_is_found_nine_times_in_ten(plan):
    """Of 60 recordings; bounds of 99 % of a binomial number of 54."""
    smallest = plan.effects.loc["viscous/constant", "smallest"]
    prior = all_effects(None)["viscous"].amplitude.prior
    odds = ANALYSIS.claims.support_log10_bayes_factor * np.log(10)
    hits = 0
    for seed in range(500, 560):
        mode, sd = known_of(made(seed, slope=smallest), (VISCOUS,))["viscous.slope"]
        hits += log_bayes_factor(mode + mode * sd**2 / prior.scale**2, sd, prior) > odds
    assert 47 <= hits <= 59


def test_what_acts_alike_is_a_pair(plan):
    """A longer spacing and a slower clock: one is the other, and no force is like them."""
    pairs = {frozenset(row) for row in plan.pairs[["effect", "other"]].to_numpy().tolist()}
    assert frozenset({"clock-scale", "length-scale"}) in pairs
    assert plan.pairs["correlation"].iloc[0] == pytest.approx(1.0, abs=1e-6)
    assert not any({"viscous", "end-asymmetry"} <= pair for pair in pairs)


def test_one_angle_leaves_c3_to_its_prior_and_another_angle_tells_it():
    design = Protocol({(9, 85.0): 2, (15, 85.0): 1}, (6.0, 28.0), (6.0, 28.0), 2)
    found = power(simulate_recording(design, seed=4, rigs=("gravity",)))
    informed = found.coefficients["informed"]
    assert not informed[["c3[small]", "c3[medium]", "c3[large]"]].any()
    assert informed[["c1[small]", "c2[large]"]].all()
    assert found.coefficients.loc["c3[large]", "sd"] == pytest.approx(1e-3, rel=1e-6)


def test_the_next_condition_is_one_that_this_size_can_have(plan):
    trials = made(1).gravity.trials
    for name, row in plan.next_condition.iterrows():
        own = trials[trials["pulley_size"] == name.partition("[")[2][:-1]]
        pairs = own[["mass_drive_kg", "mass_load_kg"]].to_numpy().tolist()
        assert [row["mass_drive_kg"], row["mass_load_kg"]] in pairs, name
        assert 0.3 < row["factor"] < 1.0


def test_a_rig_that_is_not_laid_out_is_said():
    recording = simulate_recording(DESIGN, seed=5)
    assert "motor" in power(recording).left_out
    with pytest.raises(InputError, match="laid out anew"):
        power(simulate_recording(DESIGN, seed=5, rigs=("motor",)))


def test_a_machine_of_which_nobody_knows_the_friction_is_refused_with_the_reason(tmp_path):
    recording = recorded(tmp_path / "joint", joint(3.0), rotary=True)
    with pytest.raises(InputError, match=r"found 'bench'.* gravity board.* nobody knows"):
        power(recording)


def test_the_verb_prints_it(tmp_path, plan):
    write_recording(made(1), tmp_path / "board")
    done = CliRunner().invoke(app, ["validate", str(tmp_path / "board"), "--power"])
    assert done.exit_code == 0, done.output
    for said in ("smallest found with probability 0.9", "viscous/constant", "clock-scale"):
        assert said in done.output

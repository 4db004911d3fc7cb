"""The smallest effect that would have been found, from draws whose error is known."""

from types import SimpleNamespace

import numpy as np
import pytest

from bayesfric.analysis import Analysis, ClaimRules, Normal
from bayesfric.claims.comparison import could_be_found
from bayesfric.claims.studies import Studied
from bayesfric.effects import all_effects, with_priors
from bayesfric.fitting.hypothesis import LawWithEffects
from bayesfric.inference.power import smallest_found

PRIOR = Normal(mean=0.0, sd=0.5)
RIVAL = LawWithEffects(effects=(("wrap-intercept", "linear"),))
SHARE = 0.7  # of friction at the edge, an amplitude of 1


def figures_of(draws, odds=-1.0):
    effects = with_priors(all_effects(), {"wrap-intercept": {"slope": PRIOR}})
    analysis = Analysis(claims=ClaimRules(refute_log10_bayes_factor=odds))
    case = SimpleNamespace(analysis=analysis, effects=effects)
    studied = Studied(None, theta={"wrap-intercept.slope": draws}, size=SHARE * np.abs(draws))
    return could_be_found(case, {RIVAL: studied, LawWithEffects("no-wrap"): Studied(None)})


def test_it_is_that_of_the_error_times_what_a_unit_makes_of_friction():
    error = 0.02
    sd = (1 / error**2 + 1 / PRIOR.sd**2) ** -0.5
    draws = np.random.default_rng(1).normal(0.01, sd, 50_000)
    expected = SHARE * smallest_found(error, PRIOR, np.log(10), 0.9)
    figures = figures_of(draws)
    assert figures["smallest_found"] == {"wrap-intercept/linear": pytest.approx(expected, rel=0.02)}
    assert "smallest_found_open_for" not in figures
    # Stricter odds ask for a larger effect.
    assert figures_of(draws, -3.0)["smallest_found"]["wrap-intercept/linear"] > 1.2 * expected


def test_an_amplitude_left_to_its_prior_has_a_reason_in_its_place():
    figures = figures_of(np.random.default_rng(2).normal(0.0, PRIOR.sd, 5000))
    assert figures["smallest_found"] == {}
    assert "wrap-intercept/linear: these data leave" in figures["smallest_found_open_for"]

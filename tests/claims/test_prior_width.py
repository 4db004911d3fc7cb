"""How verdicts follow the width of the rivals' priors."""

import numpy as np
import pytest
from scipy import stats

from bayesfric.analysis import Analysis, HalfNormal, Priors
from bayesfric.claims.base import Case
from bayesfric.claims.comparison import same_around, verdicts_over_widths
from bayesfric.claims.entered import Entered
from bayesfric.claims.studies import WIDTHS, Studied, prior_ratios
from bayesfric.effects import all_effects, with_priors
from bayesfric.fitting.hypothesis import LawWithEffects
from bayesfric.inference.evidence.record import Evidence

RIVAL = LawWithEffects(effects=(("viscous", "constant"),))
SCALE = 0.15
PRIORS = Priors(effects={"viscous": {"slope": HalfNormal(scale=SCALE)}})
MIDDLE = len(WIDTHS) // 2


def rival(sd):
    """A viscous slope of which data alone say half-normal, of the scale `sd`."""
    both = 1 / np.sqrt(1 / sd**2 + 1 / SCALE**2)
    slope = stats.halfnorm(scale=both).ppf((np.arange(4000) + 0.5) / 4000)
    effects = with_priors(all_effects(), PRIORS.effects)
    ratios = prior_ratios({"viscous.slope": slope}, RIVAL, effects)
    widths = np.log(np.exp(ratios).mean(axis=1))
    exact = np.log(2 * stats.norm(0, np.hypot(sd, SCALE)).pdf(0))  # of the claim it is N(0; sd)
    evidence = Evidence(float(exact), 0.0, "closed form", None)
    return Studied(evidence, "", {"viscous.slope": slope}, widths=widths, size=slope)


def test_weighted_draws_follow_the_closed_form():
    study = rival(0.02)
    exact = [np.log(2 * stats.norm(0, np.hypot(0.02, SCALE * width)).pdf(0)) for width in WIDTHS]
    assert study.widths + study.evidence.log_evidence == pytest.approx(exact, abs=0.01)


def test_an_effect_that_data_exclude_is_supported_from_that_width_on_that_gives_the_odds():
    sd = 0.02  # the 95 % bound, 0.039, is below the region of equivalence whatever the width
    study = rival(sd)
    own = np.log(2 * stats.norm(0, sd).pdf(0))
    log10 = (own - study.widths - study.evidence.log_evidence) / np.log(10)
    case = Case(None, Analysis(priors=PRIORS), Entered({}), {}, all_effects())
    verdicts = verdicts_over_widths(case, {RIVAL: study}, log10, 0.0)
    # 10 to 1 where the prior is ten times wider than what data leave.
    exact = [np.hypot(sd, SCALE * width) / sd >= 10 for width in WIDTHS]
    assert [verdict == "supported" for verdict in verdicts] == exact
    first = exact.index(True)
    assert same_around(verdicts, verdicts[MIDDLE]) == (
        (WIDTHS[first], WIDTHS[-1]) if first <= MIDDLE else (WIDTHS[0], WIDTHS[first - 1])
    )


def test_a_verdict_that_no_width_alone_gives_holds_at_its_own_only():
    assert same_around(["supported"] * len(WIDTHS), "undecided") == (WIDTHS[MIDDLE],) * 2

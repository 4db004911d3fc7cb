"""No effect is named only because the prior of another one is too tight."""

from dataclasses import replace

import numpy as np
import pytest
from rigs.friction_points import recorded

from bayesfric.analysis import Analysis
from bayesfric.checkpoint import Checkpoint
from bayesfric.diagnosis import diagnose
from bayesfric.diagnosis.beyond import _has_width, too_tight, with_wider_priors
from bayesfric.diagnosis.compared import compare_hypotheses
from bayesfric.diagnosis.judging import judge
from bayesfric.diagnosis.question import question_of
from bayesfric.diagnosis_rules import RULES
from bayesfric.families import LogNormal, Normal, TruncatedNormal, Uniform

VISCOUS = 0.8
"""Five times the scale of the prior of its slope [s/m]."""


def points(folder, viscous, drag=0.0, *, fastest=0.3, pulleys=5):
    """Return 60 points of some pulleys under the law, with friction that grows with speed."""
    rng = np.random.default_rng(1)
    tension = np.tile([5.0, 10.0, 15.0, 20.0], 15)
    speed = np.repeat(np.linspace(0.05, fastest, 15), 4)
    law = (0.0042 * tension + 0.0165) * pulleys
    at_reference = (0.0042 * 15 + 0.0165) * pulleys
    friction = law * (1 + 0.01 * rng.standard_normal(60)) + 4e-4 * pulleys * rng.standard_normal(60)
    friction += viscous * speed * at_reference + drag * speed**2
    table = {
        "velocity_m_s": speed,
        "tension_n": tension,
        "friction_n": friction,
        "pulley_size": ["medium"] * 60,
        "n_pulleys": [pulleys] * 60,
        "wrap_angle_deg": [85.0] * 60,
    }
    return recorded(folder, table)


@pytest.fixture(scope="module")
def slow(tmp_path_factory):
    """Slow points, on which friction in proportion to speed looks much like its square."""
    return points(tmp_path_factory.mktemp("slow"), VISCOUS)


def asked(recording, analysis=None):
    return question_of(recording, analysis or Analysis(), (), (), None, "paper", None, None)


def sorted_effects(question):
    compared = compare_hypotheses(question, Checkpoint(None, ""))
    args = question.law_shipped, question.practical, question.sources.draws
    return compared, judge(compared.model, compared.search, *args)


@pytest.fixture(scope="module")
def by_tight_priors(slow):
    question = asked(slow)
    return question, *sorted_effects(question)


def test_viscous_friction_far_beyond_its_prior_is_named_alone(slow, tmp_path):
    """Also where pieces are kept: those with other priors are other pieces."""
    summary = diagnose(slow, checkpoint=tmp_path / "kept").summary
    pieces = {path.name for path in (tmp_path / "kept").iterdir()}
    assert {"weigh-0000.npz", "viscous-weigh-0000.npz"} <= pieces
    assert summary.verdict == "named"
    (cause,) = summary.causes
    assert cause.effect == "viscous"
    assert not cause.plausible
    slope = cause.parameters["slope"]
    assert slope.q05 < VISCOUS < slope.q95
    assert slope.prior_density.scale == pytest.approx(1.5)
    assert any(
        line.startswith("These data may have viscous beyond its prior (slope half-normal")
        and "viscous and air-drag would be named" in line
        for line in summary.attention
    )


def test_a_prior_that_is_too_tight_is_widened_once(by_tight_priors):
    question, compared, judged = by_tight_priors
    assert set(judged.named) == {"viscous", "air-drag"}
    assert too_tight(question, compared, judged) == ("viscous",)
    wide = with_wider_priors(question, ("viscous",), judged)
    before, after = (asked.examined["viscous"].amplitude.prior for asked in (question, wide))
    assert after == before.widened(RULES.wider)
    assert wide.examined["air-drag"] == question.examined["air-drag"]
    assert "viscous" not in too_tight(wide, compared, judged)


@pytest.mark.parametrize(
    "stated",
    [
        {"priors": {"effects": {"viscous": {"slope": {"family": "half-normal", "scale": 0.15}}}}},
        {"diagnosis": {"widths": {"viscous": 1.0}}},
    ],
)
def test_a_prior_that_a_user_stated_stands(by_tight_priors, stated):
    question, compared, judged = by_tight_priors
    own = replace(question, analysis=Analysis.model_validate(stated))
    assert "viscous" not in too_tight(own, compared, judged)


@pytest.mark.parametrize(
    ("drag", "tight", "named"),
    [
        (0.0, ("viscous",), {"viscous"}),
        (0.3, ("air-drag", "viscous"), {"viscous", "air-drag"}),
    ],
)
def test_no_effect_stands_for_one_beyond_its_prior(tmp_path, drag, tight, named):
    """Of one pulley an air drag inside of its prior does what viscous friction does."""
    question = asked(points(tmp_path, VISCOUS, drag, pulleys=1))
    compared, judged = sorted_effects(question)
    assert judged.named == ["air-drag"]
    assert too_tight(question, compared, judged) == tight
    _, judged = sorted_effects(with_wider_priors(question, tight, judged))
    assert set(judged.named) == named


def test_only_where_a_verdict_names_a_cause(by_tight_priors):
    question, compared, judged = by_tight_priors
    for less in (replace(judged, named=[]), replace(judged, above=0.5)):
        assert too_tight(question, compared, less) == ()


def test_two_effects_that_the_data_tell_apart_stay_named(tmp_path):
    """Viscous friction alone would lie at 4 sd: with a wide prior it fits no better."""
    question = asked(points(tmp_path, 0.25, 0.15, fastest=1.3))
    compared, judged = sorted_effects(question)
    assert set(judged.named) == {"viscous", "air-drag"}
    assert too_tight(question, compared, judged) == ()


def test_priors_that_have_a_width():
    assert _has_width(Normal(0.0, 1.0))
    assert _has_width(TruncatedNormal(mean=0.0, sd=1.0, low=-1.0))
    assert not _has_width(Uniform(0.0, 1.0))
    assert not _has_width(LogNormal(1.0, 0.5))

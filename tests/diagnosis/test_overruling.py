"""Held-out data overrule causes by three rules, and not where they merely cannot tell."""

from types import SimpleNamespace

import numpy as np
import pytest
from report.diagnosis_sample import cause, diagnosis
from rigs.friction_points import joint, recorded

import bayesfric as bf
from bayesfric.analysis import Analysis
from bayesfric.diagnosis import measured
from bayesfric.diagnosis.acting import Acting
from bayesfric.diagnosis.answer import is_named
from bayesfric.diagnosis.classes import Classes
from bayesfric.diagnosis.held_out_density import BlockDensities
from bayesfric.diagnosis.held_out_sentence import held_out_words
from bayesfric.diagnosis.hypotheses import Search
from bayesfric.diagnosis.overruling import (
    accounts_for_residual,
    contradicts,
    density_of,
    overruled,
    why_beyond_rivals,
    why_overruled,
)
from bayesfric.diagnosis.sentence import Statement, sentence_of
from bayesfric.diagnosis.stored import excess_of
from bayesfric.diagnosis.verdict import KnownEffect
from bayesfric.diagnosis.weighing import Weighed
from bayesfric.hypothesis import Hypothesis, printed
from bayesfric.probabilities import two_digits
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import IMPLAUSIBLE, LEFT_OVER, Remainder
from bayesfric.schemas.gap import HeldOutDensity

PRACTICAL = 0.02


def shrinking(low, high):
    return Interval(mean=low, sd=0.1, q05=low, q50=0.5 * (low + high), q95=high)


def gap_of(**changes):
    return diagnosis().gap.model_copy(update=changes)


def why(gap, *, in_remainder=False):
    return why_overruled(gap, PRACTICAL, in_remainder=in_remainder)


@pytest.mark.parametrize(
    ("low", "high", "expected"), [(0.3, 0.55, True), (0.7, 0.95, False), (0.80, 0.87, True)]
)
def test_a_shrink_a_tenth_below_the_models_overrules(low, high, expected):
    """The model's interval begins at 0.974."""
    gap = gap_of(shrink=shrinking(low, high))
    assert contradicts(gap) == expected
    assert (why(gap) is not None) == expected
    assert not contradicts(gap_of(shrink=None, shrink_why="not known"))


def test_a_shrink_is_told_with_both_figures():
    said = why(gap_of(shrink=shrinking(0.3, 0.54)))
    assert said == (
        "42% of the squared gap is removed there, against 98% by the model's own estimate"
    )


@pytest.mark.parametrize(
    ("difference", "error", "expected"),
    [(21.0, 10.0, False), (19.0, 10.0, True), (-3.0, 0.5, True), (0.0, 0.0, False)],
)
def test_causes_that_predict_no_better_by_two_errors_are_overruled(difference, error, expected):
    density = HeldOutDensity(difference=difference, error=error, blocks=20)
    said = why(gap_of(held_out_log_density=density))
    assert (said is not None) == expected
    if said is not None:
        assert f"{difference:+.2g} ± {error:.2g} nat" in said


@pytest.mark.parametrize(
    ("difference", "blocks", "shrink", "expected"),
    [
        (19.0, 8, shrinking(0.96, 1.0), False),
        (9.0, 8, shrinking(0.96, 1.0), True),
        (19.0, 8, shrinking(0.4, 1.5), True),
        (19.0, 8, None, True),
        (19.0, 12, shrinking(0.96, 1.0), True),
    ],
)
def test_of_few_blocks_one_error_is_enough_beside_a_sure_shrink(
    difference, blocks, shrink, expected
):
    """A Stribeck curve of 10 % took 96 to 109 % of held-out squares, with +24 ± 13 nat of 8."""
    density = HeldOutDensity(difference=difference, error=10.0, blocks=blocks)
    gap = gap_of(held_out_log_density=density, shrink=shrink)
    assert (why(gap) is not None) == expected


def test_nothing_is_overruled_where_nobody_could_compare():
    assert why(gap_of(held_out_log_density=None, shrink=None)) is None


@pytest.mark.parametrize(
    ("share", "in_remainder", "expected"),
    [(0.03, False, True), (0.03, True, False), (0.01, False, False), (0.0, False, False)],
)
def test_what_is_left_overrules_where_it_matters_and_no_remainder_tells_it(
    share, in_remainder, expected
):
    gap = diagnosis().gap
    gap = gap.model_copy(update={"held_out_excess": share * gap.friction_rms})
    assert (why(gap, in_remainder=in_remainder) is not None) == expected
    assert not expected or f"error of {two_digits(gap.held_out_excess)} N rms" in why(
        gap, in_remainder=in_remainder
    )


@pytest.mark.parametrize(
    ("in_remainder", "implausible"), [(True, ["hysteresis"]), (True, []), (False, [])]
)
def test_a_cause_that_no_machine_has_is_overruled_where_a_remainder_is_left(
    in_remainder, implausible
):
    gap = gap_of(held_out_log_density=None, shrink=None)
    said = why_overruled(gap, PRACTICAL, in_remainder=in_remainder, implausible=implausible)
    assert (said is not None) == bool(implausible)
    assert said is None or "hysteresis would be larger or smaller" in said


def test_a_cause_that_no_machine_has_falls_by_any_force_that_is_left():
    """Held-out data leave 0.4 % of friction, less than counts, of which no remainder tells."""
    gap = gap_of(held_out_log_density=None, shrink=None)
    given = {"in_remainder": False, "implausible": ["spring"]}
    assert why_overruled(gap, PRACTICAL, **given) is None
    assert "spring would be larger" in why_overruled(gap, PRACTICAL, force_left=True, **given)


@pytest.mark.parametrize(
    ("missed", "expected"), [(0.05, False), (0.102, False), (0.106, True), (1.0, True)]
)
def test_rivals_that_would_explain_far_less_than_is_missed_are_open(missed, expected):
    """They explain 0.1 N with what scatters, nine tenths of the square of 0.1043 N."""
    gap = diagnosis().gap
    size = {"q05": 0.05, "q50": 0.06, "q95": 0.0707}
    gap = gap.model_copy(
        update={
            "before": gap.before.model_copy(update={"q05": missed}),
            "systematic": gap.systematic.model_copy(update=size),
            "floor": gap.floor.model_copy(update=size),
        }
    )
    said = why_beyond_rivals(gap)
    assert (said is not None) == expected
    assert said is None or f"missed by {missed:.3g} N rms or more" in said


def test_what_is_left_beyond_chance_is_a_root_of_squares():
    """Chance makes 4 ± 0.4 N² beside a gap of none: 13 N² leave 3 N, and 5 N² are chance."""
    by_chance = 4 + 0.4 * np.random.default_rng(2).standard_normal(4000)
    assert excess_of(13.0, by_chance, np.zeros(3)) == pytest.approx(3.0, abs=0.01)
    assert excess_of(13.0, by_chance, np.full(3, 5.0)) == pytest.approx(2.0, abs=0.01)
    assert excess_of(4.8, by_chance, np.zeros(3)) == 0.0
    assert excess_of(1.0, by_chance, np.zeros(3)) == 0.0


def test_hypotheses_with_what_is_overruled_are_of_an_unknown_force():
    """Nineteen in twenty of them; what was found beside is still told."""
    at = SimpleNamespace()
    weighed = {
        Hypothesis(names): Weighed(names, value, None, Acting(), at)
        for names, value in (((), 0.0), (("viscous",), 20.0), (("slip", "viscous"), 24.0))
    }
    classes = Classes(members=(("slip",), ("viscous",)), absorbed=(), left_out={})
    priors = Analysis().diagnosis.hypotheses
    search = Search(weighed, {}, None, classes, priors, np.eye(1), 0.0)
    before = printed(search.probabilities())
    effects_known = [KnownEffect("viscous", 1.0, 1.0, 0.1), KnownEffect("slip", 0.9, 0.0, 0.001)]
    after = overruled(search, effects_known, [["viscous"]], 1.0)
    chances = printed(after.search.probabilities())
    acting = before["viscous"] + before["slip+viscous"]
    assert chances["unknown"] == pytest.approx(0.95 * acting)
    assert {effect.effect: effect.probability for effect in after.effects_known}[
        "viscous"
    ] == pytest.approx(0.05 * acting)
    assert "viscous" not in after.present + after.possible


def test_why_nobody_compared_is_told():
    assert "fewer than 4" in density_of(None, ["viscous"])["held_out_log_density_why"]
    assert "no cause" in density_of(None, [])["held_out_log_density_why"]


@pytest.mark.parametrize(
    ("effects", "words"),
    [
        (["viscous"], "viscous explains the data of the fit but not held-out data: so and so."),
        (["viscous", "slip"], "viscous and slip explain the data of the fit but not held-out data"),
    ],
)
def test_the_sentence_says_what_was_overruled_and_by_which_rule(effects, words):
    statement = Statement(
        "unknown",
        0.97,
        gap_of(),
        PRACTICAL,
        considered=[cause(name) for name in effects],
        overruled_by="so and so",
    )
    said = sentence_of(statement)
    assert words in said
    assert "Something else acts (probability 0.970)" in said


def test_a_cause_that_held_out_data_confirm_is_said_to_miss_a_part():
    """Gravity that took 98 % of a public joint's held-out gap was sentence to miss all of it."""
    why = f"held-out data leave 2.7 N·m rms, and {LEFT_OVER}"
    statement = Statement(
        "unknown", 0.95, gap_of(), PRACTICAL, considered=[cause("viscous")], overruled_by=why
    )
    sentence = sentence_of(statement)
    assert f"but only part of the held-out data: {why}. Something else acts too (" in sentence


def test_what_is_implausible_is_not_said_to_miss_what_was_held_out():
    """Nor is a share past all by rounding said to come from scatter."""
    why = f"air-drag would be {IMPLAUSIBLE}, and a force that no effect explains is left"
    effects = [cause("air-drag").model_copy(update={"plausible": False})]
    statement = Statement(
        "unknown", 0.95, gap_of(), PRACTICAL, considered=effects, overruled_by=why
    )
    assert "The closest effect examined is air-drag, but the " in sentence_of(statement)
    assert "but not held-out data" not in sentence_of(statement)
    density = HeldOutDensity(difference=1283.0, error=88.4, blocks=20)
    all_of_it = Interval(mean=1.0, sd=0.0, q05=0.9996, q50=0.9999, q95=1.0002)
    said = held_out_words(
        gap_of(shrink=all_of_it, held_out_log_density=density), effects, "unknown"
    )
    assert "adding air-drag removes more than 99.9% of the gap (mean square)." in said
    assert "scatter" not in said


@pytest.mark.parametrize("gain", [1.0, 9.0])
def test_a_cause_that_predicts_no_better_is_considered_and_the_verdict_unknown(
    tmp_path, monkeypatch, gain
):
    """Blocks that the cause makes more likely by one nat each, ± 3 or ± a third of one."""
    gains = np.ones(9) + np.tile([-1.0, 0.0, 1.0], 3) * 10 / gain
    densities = BlockDensities(np.zeros(9), gains)
    monkeypatch.setattr(measured, "block_densities", lambda *_: densities)
    summary = bf.diagnose(recorded(tmp_path / "bench", joint(2.0))).summary
    density = summary.gap.held_out_log_density
    assert (density.difference, density.blocks) == (pytest.approx(9.0), 9)
    if gain > 1:
        assert summary.verdict == "named"
        return
    assert summary.verdict == "unknown"
    assert summary.probabilities["unknown"] > 0.9
    assert summary.causes == ()
    assert [cause.effect for cause in summary.considered] == ["viscous"]
    assert "no better than by the law alone" in summary.overruled_by
    assert f"but not held-out data: {summary.overruled_by}" in summary.sentence
    assert any("Held-out data contradict viscous" in line for line in summary.attention)
    assert all(check.holds for check in summary.checks)


@pytest.mark.parametrize(("left", "is_told"), [(0.01, True), (0.5, False)])
def test_a_small_remainder_does_not_tell_what_is_many_times_larger(left, is_told):
    """Of a gap of 0.1 N it is a quarter of the squares: 0.05 N."""

    def sure(value):
        return Interval(mean=value, sd=0.0, q05=value, q50=value, q95=value)

    gap = diagnosis().gap.model_copy(update={"held_out_excess": left, "systematic": sure(0.1)})
    remainder = Remainder(
        significant=True, log10_bayes_factor=3.0, share_of_gap=sure(0.25), axis="velocity"
    )
    assert accounts_for_residual(remainder, gap) is is_told
    nothing = remainder.model_copy(update={"significant": False})
    assert not accounts_for_residual(nothing, gap)


def test_an_effect_is_named_by_its_whole_name_alone():
    words = "viscous-asymmetry and load-stribeck fit what was recorded."
    assert is_named("viscous-asymmetry", words)
    assert not is_named("viscous", words)
    assert not is_named("stribeck", words)
    assert is_named("stribeck", "stribeck, which fits,")

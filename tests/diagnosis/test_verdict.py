"""The verdict by the rules of the contract."""

from types import SimpleNamespace

import numpy as np
import pytest
from report.diagnosis_sample import axis, cause, diagnosis

from bayesfric.analysis import Analysis
from bayesfric.diagnosis import remainder
from bayesfric.diagnosis.acting import Acting, At
from bayesfric.diagnosis.discrepancy import Wide
from bayesfric.diagnosis.forms import FormShare
from bayesfric.diagnosis.remainder import left_matters, remainder_of
from bayesfric.diagnosis.sentence import Statement, sentence_of
from bayesfric.diagnosis.showing import window_words
from bayesfric.diagnosis.unknown import Unknown
from bayesfric.diagnosis.verdict import KnownEffect, decide, sets_of_one, sort_effects
from bayesfric.diagnosis.weighing import Weighed
from bayesfric.hypothesis import parsed
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import IMPLAUSIBLE, Unseparated


def effect_with(effect="viscous", probability=0.99, above=1.0, **options):
    return KnownEffect(effect, probability, above, options.pop("strength", 0.1), **options)


@pytest.mark.parametrize(
    ("examined", "expected"),
    [
        (effect_with(), "cause"),
        (effect_with(probability=0.89), "possible"),
        (effect_with(above=0.4), "present"),
        (effect_with(probability=0.05), None),
        (effect_with(above=0.0, measuring=True, strength=0.01), "cause"),
        (effect_with(above=0.0, measuring=True, strength=0.001), "present"),
    ],
)
def test_an_effect_is_a_cause_or_present_or_possible(examined, expected):
    names_by_kind = dict(
        zip(("cause", "present", "possible"), sort_effects([examined]), strict=True)
    )
    assert {kind for kind, names in names_by_kind.items() if names} == ({expected} - {None})


CHANCES = {"viscous": 0.95, "none": 0.03, "unknown": 0.02}


@pytest.mark.parametrize(
    ("chances", "causes", "above", "together", "verdict", "probability"),
    [
        ({"unknown": 0.6, "viscous": 0.4}, [effect_with()], 1.0, (), "unknown", 0.6),
        (CHANCES, [effect_with()], 0.95, (), "named", 0.95),
        (CHANCES, [effect_with()], 0.5, (), "undecided", 0.5),
        (CHANCES, [effect_with(measuring=True)], 0.0, (), "no-gap", 1.0),
        (CHANCES, [effect_with(measuring=True)], 0.5, (), "undecided", 0.5),
        (CHANCES, [effect_with(measuring=True)], 0.95, (), "named", 0.95),
        ({"unknown": 0.6, "viscous": 0.4}, [], 0.05, (), "no-gap", 0.95),
        ({"a": 0.5, "b": 0.45, "none": 0.05}, [], 0.95, (("a", "b"),), "unseparated", 0.95),
        ({"none": 0.9, "a": 0.1}, [], 0.04, (), "no-gap", 0.96),
        ({"none": 0.6, "a": 0.4}, [], 0.3, (), "undecided", 0.7),
    ],
)
def test_the_verdict(chances, causes, above, together, verdict, probability):
    assert decide(parsed(chances), causes, above, together) == (verdict, pytest.approx(probability))


def test_data_that_could_not_have_shown_a_gap_show_none():
    """The prior is left: of nothing acting 0.6, and of no more."""
    chances = parsed({"none": 1.0, "unknown": 0.0})
    assert decide(chances, [], 0.0, (), none_before=0.6, shown=False) == ("undecided", 0.6)
    assert decide(chances, [], 0.0, (), none_before=0.6) == ("no-gap", 1.0)
    # Where a gap is there, data have shown one.
    assert decide(parsed(CHANCES), [effect_with()], 0.95, (), shown=False)[0] == "named"


def test_an_error_of_sensors_that_makes_no_gap_is_present():
    """Magnets 0.05 mm off: felt in every reading, and no part of a gap."""
    magnets = effect_with("magnet-spacing", measuring=True, above=0.0, strength=0.01)
    assert sort_effects([magnets], 0.0) == ([], ["magnet-spacing"], [])
    assert sort_effects([magnets], 0.05) == ([], ["magnet-spacing"], [])
    assert sort_effects([magnets], 0.5) == (["magnet-spacing"], [], [])


def test_effects_of_which_one_acts():
    chances = parsed({"a": 0.5, "b": 0.43, "none": 0.07})
    rivals = [effect_with("a", 0.5), effect_with("b", 0.43), effect_with("c", 0.0)]
    assert sets_of_one(chances, rivals, []) == (("a", "b"),)
    assert sets_of_one(parsed({"a": 0.5, "none": 0.5}), rivals[:1], []) == ()


def in_words(verdict, gap, share, causes=(), **more):
    """Return a verdict of probability 0.97 in words."""
    return sentence_of(Statement(verdict, 0.97, gap, share, causes, **more))


@pytest.mark.parametrize("verdict", ["no-gap", "undecided"])
def test_a_cause_without_a_sure_gap_is_in_the_sentence(verdict):
    """An effect of a practical size acts, and the refitted law absorbs most of its force."""
    gap = diagnosis().gap
    open_still = gap.systematic.model_copy(update={"q05": 0.01 * gap.friction_rms})
    gap = gap.model_copy(update={"systematic": open_still})

    def sentence(causes):
        return in_words(verdict, gap, 0.02, causes)

    assert "viscous acts" in sentence([cause("viscous")])
    assert "acts" not in sentence([])
    assert ("no cause is sure" in sentence([])) == (verdict == "undecided")
    assert "no cause is sure" not in sentence([cause("viscous")])
    # One that acts, and is each less than what counts, is in it too.
    weak = in_words(verdict, gap, 0.02, present=[cause("cogging", strength=0.01)])
    assert "cogging acts" in weak
    assert "no cause is sure" not in weak


def test_a_gap_that_is_less_likely_than_not_is_not_said_to_be_there():
    gap = diagnosis().gap.model_copy(update={"probability_above_practical": 0.25})
    said = in_words("undecided", gap, 0.02, open_because="few windows")
    assert "stays open (its probability is 0.25): few windows" in said
    assert "There is a gap" not in said


def test_a_gap_that_is_surely_there_is_not_said_to_be_open():
    gap = diagnosis().gap
    share = gap.systematic.q05 / gap.friction_rms
    there = in_words("undecided", gap, 0.9 * share)
    assert "(probability 0.970); its cause stays open" in there
    assert "The gap is 0.049 N rms, " in in_words("undecided", gap, 1.1 * share)
    both = [cause("viscous"), cause("stribeck")]
    together = in_words("undecided", gap, 0.9 * share, present=both)
    assert together.endswith(f"; viscous and stribeck act, each less than {0.9 * share:.1%}.")
    alone = in_words("undecided", gap, 0.9 * share, present=both[:1])
    assert f"viscous acts, less than {0.9 * share:.1%}; what else causes it stays open." in alone


def test_an_undecided_gap_is_told_in_full_before_what_is_open():
    """1.98 to 2.02 % of 2.13 N, where 2 % counts: two digits would hide the difference."""
    gap = diagnosis().gap
    systematic = gap.systematic.model_copy(
        update={"q05": 0.0198 * 2.13, "q50": 0.02 * 2.13, "q95": 0.0202 * 2.13}
    )
    about = gap.model_copy(update={"systematic": systematic, "friction_rms": 2.13})
    assert in_words("undecided", about, 0.02, [cause("viscous")]) == (
        "The gap is 0.043 N rms, 2.0% of friction (1.98 to 2.02%); viscous acts; whether the gap "
        "is above 2.0% of friction stays open."
    )


def test_a_gap_of_nothing_has_no_figure():
    gap = diagnosis().gap
    nothing = gap.systematic.model_copy(update={"q50": 1e-19})
    gap = gap.model_copy(update={"systematic": nothing})
    assert in_words("no-gap", gap, 0.02).endswith(
        "the median of the gap is less than 0.1% of friction."
    )


def test_an_unknown_force_that_is_too_small_to_count_is_said_to_be_so():
    gap = diagnosis().gap
    share = gap.systematic.q50 / gap.friction_rms

    def sentence(practical):
        return in_words("unknown", gap, practical)

    small = sentence(1.1 * share)
    assert small.startswith("A force acts that none of the effects examined explains (probability ")
    assert f"Its gap is small: {gap.systematic.q50:.2g} N rms" in small
    assert f"; below {1.1 * share:.1%} of friction a gap is negligible." in small
    assert "There is a gap" not in small
    assert sentence(0.9 * share).startswith(
        "With probability 0.970 there is a gap that none of the effects examined explains: 0.049 N"
    )


def test_no_gap_says_how_much_was_recorded():
    said = in_words("no-gap", diagnosis().gap, 0.1, recorded="60 windows, each a mean")
    assert said.endswith("% of friction). This rests on 60 windows, each a mean.")


@pytest.mark.parametrize(
    ("trial", "words"),
    [
        ([0, 1, 2], "3 steady points"),
        ([0, 0, 0], "3 windows, each the mean friction over a stretch of motion"),
        ([0, 0, 1], "3 windows, each the mean friction over a stretch of motion or at a steady "
                    "point"),
    ],
)  # fmt: skip
def test_a_window_is_what_the_rig_records(trial, words):
    assert window_words(SimpleNamespace(trial=np.array(trial), independent=3)) == words


def test_a_gap_of_sensors_alone_is_told_as_none():
    gap = diagnosis().gap
    magnets = cause("magnet-spacing", strength=0.05, makes_a_gap=False)
    sentence = in_words("no-gap", gap, 0.02, present=[magnets])
    assert sentence.endswith(" magnet-spacing acts, which makes no gap.")


def test_what_data_could_not_have_shown_is_said():
    why = "1 window of motion for 2 numbers of the law, and 6 are needed"
    sentence = in_words("undecided", diagnosis().gap, 0.02, not_shown=why)
    assert sentence == f"These data could not have shown a gap of 2.0% of friction: {why}."


def test_no_share_is_told_of_friction_that_may_be_nothing():
    """Of 1e-7 N within an error of 0.01 N, a force of 0.05 N is no 49300000 %."""
    why = "friction is within its error of zero, 0.001 ± 0.01 N"
    gap = diagnosis().gap.model_copy(update={"friction_rms": 1e-7, "no_share": why})
    for verdict in ("no-gap", "undecided", "unknown", "unseparated", "named"):
        sentence = in_words(verdict, gap, 0.02, [cause("viscous")] if verdict == "named" else ())
        assert "0.049 N rms" in sentence or verdict == "undecided"
        assert "% of friction" not in sentence
    assert why in in_words("no-gap", gap, 0.02)


def test_an_implausible_effect_is_rejected_by_its_figures():
    """Its size and the plausible range are in the sentence, and how near it comes."""
    drag = cause("air-drag", plausible=False, plausible_range=(0.0, 0.05))
    why = f"air-drag would be {IMPLAUSIBLE}, and a force that no effect explains is left"
    said = in_words("unknown", diagnosis().gap, 0.02, considered=[drag], overruled_by=why)
    assert said.endswith(
        "that none of the effects examined explains (probability 0.970). The closest effect "
        "examined is air-drag, but the slope of air-drag is 0.123 s/m, outside of the plausible 0 "
        "to 0.05, and a force that no effect explains is left."
    )
    assert said.startswith("There is a gap of 0.049 N rms (")


@pytest.mark.parametrize("verdict", ["undecided", "unknown", "unseparated"])
def test_a_larger_gap_on_held_out_data_stands_beside_the_smaller_of_the_fit(verdict):
    """0.049 N on the data of the fit and 0.4 N on others are both said; 0.04 N adds nothing."""
    gap = diagnosis().gap
    for excess, is_said in ((0.4, True), (0.04, False)):
        held_out = gap.model_copy(update={"held_out_excess": excess})
        sentence = in_words(verdict, held_out, 0.02, open_because="the joint reverses once")
        both = "in the data of the fit, and of 0.4 N rms in data that it has not seen"
        assert (both in sentence) == is_said, sentence


def placed(*shares, leads):
    """Return axes with these shares, of which the first may lead."""
    names = ("velocity", "setup", "n_pulleys")
    return tuple(
        axis(name, "1", share, leads=leads and not place)
        for place, (name, share) in enumerate(zip(names, shares, strict=False))
    )


@pytest.mark.parametrize("verdict", ["unknown", "named", "unseparated"])
def test_a_sentence_names_an_axis_where_it_leads_and_nowhere_else(verdict):
    gap, causes = diagnosis().gap, [cause("viscous")] if verdict == "named" else ()

    def said(where):
        return in_words(verdict, gap, 0.02, causes, where=where)

    lies = "It varies most with velocity."
    assert lies in said(placed(0.6, 0.1, leads=True))
    for where in (placed(0.3, 0.3, leads=False), placed(0.1, 0.02, leads=True), ()):
        assert "varies most" not in said(where)


def test_effects_of_which_one_acts_beside_a_cause_are_in_the_sentence():
    rivals = (Unseparated(effects=("air-drag", "stribeck"), reason="these-data"),)
    gap = diagnosis().gap
    both = in_words("named", gap, 0.02, [cause("viscous")], unseparated=rivals)
    assert both.startswith("viscous acts (probability 0.970).")
    assert both.endswith("One of air-drag, stribeck acts beside it; these data cannot tell which.")
    assert "One of" not in in_words("named", gap, 0.02, [cause("viscous")])


@pytest.mark.parametrize(
    ("low", "words"),
    [
        (0.9995, "removes more than 99.9% of this systematic gap (mean square)"),
        (0.95, "removes 99.0% [95.0%, 99.5%]"),
    ],
)
def test_a_shrink_is_never_told_as_all_of_the_gap(low, words):
    shrink = Interval(mean=0.99, sd=0.01, q05=low, q50=max(low, 0.99), q95=max(low, 0.995))
    gap = diagnosis().gap.model_copy(update={"shrink_of_model": shrink})
    assert words in in_words("named", gap, 0.02, [cause("viscous")])


@pytest.mark.parametrize(
    ("left", "gap", "practical", "matters"),
    [
        (0.02, 0.047, 0.005, True),  # 0.66 % of friction
        (0.02, 0.047, 0.02, False),
        (0.03, 0.047, 0.02, True),  # more than a fortieth of the squared gap
        (-0.01, 0.047, 0.005, False),
    ],
)
def test_what_causes_leave_matters_beyond_a_part_of_the_gap_or_of_friction(
    left, gap, practical, matters
):
    draws = left + np.linspace(0.0, 1e-4, 201)
    assert left_matters(draws, gap, practical) == matters


NUMBERS = np.zeros(0)
AT = At(NUMBERS, 0.0, None, SimpleNamespace(), NUMBERS, np.zeros((0, 0)), at_mode=True)


@pytest.mark.parametrize(
    ("left", "beside", "share", "axis"),
    [
        (0.31, 0.02, 0.31, "velocity"),  # causes in place of a step in speed
        (0.03, 0.20, 0.20 / 1.20, "travel"),
        (None, 0.20, 0.20 / 1.20, "travel"),
    ],
)
def test_a_remainder_is_all_that_causes_leave(monkeypatch, left, beside, share, axis):
    """A force beside the causes and what their laws leave speak of one thing: the larger tells."""
    gap = 0.07

    def smooth(share, axis):
        return Unknown((Wide(share, axis),), np.zeros(1), 30.0, AT, Acting())

    def unknown_force(model, weighed, *rest):
        instead = weighed.form.size == 0
        return smooth(gap, "velocity") if instead else smooth(np.sqrt(beside) * gap, "travel")

    monkeypatch.setattr(remainder, "unknown_force", unknown_force)
    model = SimpleNamespace(analysis=Analysis(), evaluate=lambda *_: SimpleNamespace(value=0.0))
    model.reweighted, model.weight_volume = lambda *_: model, 0.0  # its scatter is normal
    weighed = Weighed(("viscous",), 0.0, None, Acting(), AT, form=FormShare(0.1))
    draws = None if left is None else left + np.linspace(-0.01, 0.01, 201)
    left_over = remainder_of(model, SimpleNamespace(inverse=None, volume=0.0), weighed, gap, draws)
    assert left_over.significant
    assert left_over.axis == axis
    assert left_over.share_of_gap.q50 == pytest.approx(share, abs=1e-3)


def test_a_remainder_without_evidence_is_not_significant(monkeypatch):
    """Laws that are wrong by a share leave a third of the gap, at a log10 factor of -2.4."""

    def unknown_force(model, weighed, *rest):
        return Unknown((Wide(0.05, "velocity"),), np.zeros(1), -2.4 * np.log(10), AT, Acting())

    monkeypatch.setattr(remainder, "unknown_force", unknown_force)
    model = SimpleNamespace(analysis=Analysis(), evaluate=lambda *_: SimpleNamespace(value=0.0))
    model.reweighted, model.weight_volume = lambda *_: model, 0.0  # its scatter is normal
    weighed = Weighed(("viscous",), 0.0, None, Acting(), AT, form=FormShare(0.1))
    draws = 0.31 + np.linspace(-0.01, 0.01, 201)
    left_over = remainder_of(model, SimpleNamespace(inverse=None, volume=0.0), weighed, 0.07, draws)
    assert not left_over.significant
    assert left_over.log10_bayes_factor == pytest.approx(-2.4)
    assert left_over.share_of_gap is None

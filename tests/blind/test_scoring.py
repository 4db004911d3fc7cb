"""A verdict against a truth: what is correct, falsely named, flagged and covered."""

import pytest
from blind.verdicts import PRACTICAL, diagnosed, interval

from bayesfric.blind.engines.catalogue import EFFECTS
from bayesfric.blind.engines.mujoco_board import MECHANISMS
from bayesfric.blind.scoring import LAWS_OF_FORMS, score
from bayesfric.effects import all_effects
from bayesfric.schemas.causes import Remainder, Unseparated

PUBLIC = {
    "name": "000007",
    "seed": 7,
    "engine": "reference",
    "design": "quick",
    "envelope_sha256": "d" * 64,
    "recording_sha256": "e" * 64,
}
TWINS = (Unseparated(effects=("clock-scale", "length-scale"), reason="identical-on-this-rig"),)
OPEN = (Unseparated(effects=("clock-scale", "viscous"), reason="these-data"),)
RIVALS = (Unseparated(effects=("viscous", "air-drag"), reason="these-data"),)


def effect(name, **more):
    return {"name": name, "form": "constant", "own": True, "strength": 1.0} | more


def judged(withheld, *, gap=0.05, true_shrink=None, **changes):
    summary = diagnosed(**changes)
    truth = {"withheld": withheld}
    numbers = {"gap": gap, "true_shrink": true_shrink, "oracle_power": None}
    return score(PUBLIC, truth, summary, **numbers, effect_names=all_effects())


def left(axis, low, significant=True):
    share = interval(low + 0.1645, 0.1)  # its 5 % quantile is `low`
    return Remainder(significant=significant, log10_bayes_factor=3.0, share_of_gap=share, axis=axis)


@pytest.mark.parametrize(
    ("withheld", "changes", "expected"),
    [
        (["viscous"], {"causes": ["viscous"]}, ("viscous", True, False)),
        (["viscous"], {"causes": ["air-drag"]}, ("air-drag", False, True)),
        (
            ["viscous"],
            {"causes": ["viscous", "air-drag"]},
            ("other-combination", False, True),
        ),
        (["viscous"], {"verdict": "no-gap", "causes": []}, ("none", False, False)),
        (["viscous"], {"verdict": "unknown", "causes": []}, ("unknown", False, False)),
        (["viscous"], {"verdict": "undecided", "causes": []}, ("undecided", False, False)),
        # Nor does a cause make it correct: the verdict does not name it.
        (["viscous"], {"verdict": "undecided"}, ("undecided", False, False)),
        # What these data leave open is not named, even where the truth is among it.
        (
            ["viscous"],
            {"verdict": "unseparated", "causes": ["viscous"], "unseparated": RIVALS},
            ("unseparated", False, False),
        ),
        # An alias counts where the class is reported whole, and only there.
        (
            ["length-scale"],
            {"causes": ["clock-scale"], "unseparated": TWINS},
            ("length-scale", True, False),
        ),
        (["length-scale"], {"causes": ["clock-scale"]}, ("clock-scale", False, True)),
        (["viscous", "runout"], {"causes": ["runout", "viscous"]}, ("pair", True, False)),
        (["viscous", "runout"], {"causes": ["viscous"]}, ("viscous", False, True)),
        (
            ["viscous", "runout"],
            {"causes": ["viscous", "stribeck"]},
            ("other-combination", False, True),
        ),
        ([], {"verdict": "no-gap", "causes": []}, ("none", True, False)),
        ([], {"verdict": "undecided", "causes": []}, ("undecided", True, False)),
        # A cause is told of that is not there.
        ([], {"verdict": "no-gap"}, ("none", False, False)),
        ([], {"verdict": "undecided"}, ("undecided", False, False)),
        ([], {"causes": ["viscous"]}, ("viscous", False, True)),
        ([], {"verdict": "unknown", "causes": []}, ("unknown", False, False)),
    ],
)
def test_a_verdict_is_correct_where_it_names_exactly_what_is_there(withheld, changes, expected):
    case = judged([effect(name) for name in withheld], gap=0.05 if withheld else 0.0, **changes)
    assert (case.outcome, case.correct, case.falsely_named) == expected


@pytest.mark.parametrize(
    ("names", "causes"),
    [
        (["length-scale"], ["clock-scale", "length-scale"]),  # one stands for it, not both
        (["clock-scale", "length-scale"], ["clock-scale", "viscous"]),  # viscous is not there
    ],
)
def test_twins_do_not_hide_what_is_wrong(names, causes):
    case = judged([effect(name) for name in names], causes=causes, unseparated=TWINS)
    assert not case.correct


def test_a_pair_of_one_class_is_not_named_by_one_of_them_twice():
    case = judged(
        [effect("viscous"), effect("length-scale")],
        causes=["clock-scale", "length-scale"],
        unseparated=TWINS,
    )
    assert not case.correct


@pytest.mark.parametrize(
    ("gap", "as_none"), [(0.99 * PRACTICAL, True), (1.01 * PRACTICAL, False), (None, False)]
)
def test_what_is_below_the_practical_share_counts_as_none(gap, as_none):
    for verdict in ("no-gap", "undecided"):
        case = judged([effect("viscous")], gap=gap, verdict=verdict, causes=[])
        assert (case.counts_as_none, case.correct) == (as_none, as_none)
        assert (case.noise_free_gap_why is None) == (gap is not None)
        # A cause that is there may be told of, and no other.
        viscous_case = judged([effect("viscous")], gap=gap, verdict=verdict, causes=["viscous"])
        assert viscous_case.correct is as_none
        assert not judged([effect("viscous")], gap=gap, verdict=verdict, causes=["slip"]).correct
    named = judged([effect("viscous")], gap=gap, causes=["viscous"])
    assert named.correct  # it is there, however small
    assert not named.falsely_named
    wrong = judged([effect("viscous")], gap=gap, causes=["stribeck"])
    assert not wrong.correct
    assert wrong.falsely_named


@pytest.mark.parametrize(
    ("withheld", "gap", "changes", "true"),
    [
        # These causes act, whatever acts beside them.
        (["viscous", "runout"], 0.05, {"causes": ["viscous"]}, True),
        (["viscous"], 0.05, {"causes": ["viscous", "runout"]}, False),
        (["length-scale"], 0.05, {"causes": ["clock-scale"], "unseparated": TWINS}, True),
        (["wave"], 0.05, {"causes": ["viscous"]}, False),
        # One of the set acts, or what is the same as one of it on this rig.
        (["air-drag"], 0.05, {"verdict": "unseparated", "unseparated": RIVALS}, True),
        (["runout"], 0.05, {"verdict": "unseparated", "unseparated": RIVALS}, False),
        (["runout", "viscous"], 0.05, {"verdict": "unseparated", "unseparated": RIVALS}, True),
        (["length-scale"], 0.05, {"verdict": "unseparated", "unseparated": (*OPEN, *TWINS)}, True),
        (["length-scale"], 0.05, {"verdict": "unseparated", "unseparated": OPEN}, False),
        # A class of twins is no set of which one acts.
        (["length-scale"], 0.05, {"verdict": "unseparated", "unseparated": TWINS}, False),
        ([], 0.0, {"verdict": "unseparated", "unseparated": RIVALS}, False),
        (["wave"], 0.05, {"verdict": "unknown"}, True),
        (["viscous"], 0.05, {"verdict": "unknown"}, False),
        # The gap is below the practical share, or on the likelier side of it.
        (["viscous"], 0.05, {"verdict": "no-gap", "above": 0.02}, False),
        (["viscous"], 0.01, {"verdict": "no-gap", "above": 0.02}, True),
        (["viscous"], 0.05, {"verdict": "undecided", "above": 0.7}, True),
        (["viscous"], 0.05, {"verdict": "undecided", "above": 0.3}, False),
        ([], 0.0, {"verdict": "undecided", "above": 0.7}, False),
        ([], 0.0, {"verdict": "undecided", "above": 0.3}, True),
    ],
)
def test_a_verdict_comes_true_where_what_it_states_is_so(withheld, gap, changes, true):
    changes = {"causes": []} | changes
    effects = [effect(name, axes=["order"]) for name in withheld]
    assert judged(effects, gap=gap, **changes).came_true is true


@pytest.mark.parametrize(
    ("changes", "flagged"),
    [
        ({"verdict": "unknown", "causes": []}, True),
        ({"remainder": left("order", 0.11)}, True),
        ({"remainder": left("order", 0.09)}, False),  # too small a share
        ({"remainder": left("tension", 0.5)}, False),  # a wrong axis
        ({"remainder": left("order", 0.5, significant=False)}, False),
        ({"verdict": "no-gap", "causes": []}, False),
    ],
)
def test_an_outsider_is_flagged_by_unknown_or_a_remainder_on_a_true_axis(changes, flagged):
    case = judged([effect("wave-in-order", own=False, axes=["order", "displacement"])], **changes)
    assert case.kind == "outsider"
    assert (case.flagged, case.correct) == (flagged, flagged)


def test_naming_an_effect_for_an_outsider_is_false():
    case = judged([effect("wave-in-order", own=False, axes=["order"])], causes=["wear-drift"])
    assert case.falsely_named


def test_intervals_cover_where_they_hold_the_truth():
    # The sample's slope is 0.123 ± 1.645 · 0.006, its shrink 0.981 ± 1.645 · 0.004.
    inside = judged([effect("viscous", parameters={"slope": 0.132})], true_shrink=0.986)
    assert (inside.parameters_covered, inside.shrink_covered) == ({"viscous.slope": True}, True)
    outside = judged([effect("viscous", parameters={"slope": 0.134})], true_shrink=0.99)
    assert (outside.parameters_covered, outside.shrink_covered) == ({"viscous.slope": False}, False)
    foreign = judged([effect("viscous", own=False, parameters={"slope": 0.12})])
    assert (foreign.parameters_covered, foreign.shrink_covered) == ({}, None)
    wrong = judged([effect("stribeck", parameters={"slope": 0.12})], true_shrink=0.98)
    assert (wrong.parameters_covered, wrong.shrink_covered) == ({}, None)


@pytest.mark.parametrize(
    ("name", "form", "law", "covered"),
    [
        ("tension-curvature", "quadratic", "quadratic", {"tension-curvature.slope": True}),
        ("tension-curvature", "quadratic", "power", {}),  # other numbers for one curve
        ("viscous", "with-tension", "tension", {"viscous.slope": True}),
        ("viscous", "with-tension", "constant", {}),
        ("viscous", "in words of a user", "constant", {}),
    ],
)
def test_parameters_are_compared_with_those_of_the_same_law_alone(name, form, law, covered):
    summary = diagnosed(causes=[name])
    causes = (summary.causes[0].model_copy(update={"law": law}),)
    truth = effect(name, form=form, parameters={"slope": 0.12})
    numbers = {"gap": 0.05, "true_shrink": 0.981, "oracle_power": None}
    summary = summary.model_copy(update={"causes": causes})
    case = score(PUBLIC, {"withheld": [truth]}, summary, **numbers, effect_names=all_effects())
    assert case.parameters_covered == covered
    assert case.shrink_covered is True


def test_each_own_form_that_an_engine_withholds_is_a_law_of_the_diagnosis():
    laws = {name: set(effect_.laws) for name, effect_ in all_effects().items()}
    forms = {(kind.name, form.name) for kind in EFFECTS.values() for form in kind.forms if form.own}
    forms |= {(mechanism.name, mechanism.part) for mechanism in MECHANISMS}
    assert set(LAWS_OF_FORMS) <= forms
    for name, form in forms:
        assert LAWS_OF_FORMS.get((name, form), form) in laws[name], (name, form)


def test_the_probability_of_the_truth_is_that_of_its_hypothesis():
    chances = {"viscous": 0.96, "viscous+stribeck": 0.02, "unknown": 0.015, "none": 0.005}

    def chance(*withheld, **more):
        return judged(list(withheld), probabilities=chances, **more).truth_probability

    assert chance(effect("viscous")) == 0.96
    assert chance(effect("stribeck"), effect("viscous")) == 0.02
    assert chance(effect("wave", axes=["order"])) == 0.015
    assert chance(gap=0.0) == 0.005

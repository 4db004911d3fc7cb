"""A verdict against a truth: what is correct, falsely named, flagged and covered."""

import pytest
from report.diagnosis_sample import cause, diagnosis, interval

from bayesfric.blind.scoring import score
from bayesfric.effects import all_effects
from bayesfric.schemas import Remainder, Unseparated

PUBLIC = {
    "name": "000007",
    "seed": 7,
    "engine": "reference",
    "design": "quick",
    "envelope_sha256": "d" * 64,
    "recording_sha256": "e" * 64,
}
TWINS = (Unseparated(effects=("clock-scale", "length-scale"), reason="identical-on-this-rig"),)
RIVALS = (Unseparated(effects=("viscous", "air-drag"), reason="these-data"),)


def effect(name, **more):
    return {"name": name, "form": "plain", "own": True, "strength": 1.0} | more


def judged(withheld, *, gap=0.03, true_shrink=None, **changes):
    if "causes" in changes:
        changes["causes"] = tuple(cause(name) for name in changes["causes"])
    found = diagnosis(**({"unseparated": ()} | changes))
    truth = {"withheld": withheld}
    numbers = {"gap": gap, "true_shrink": true_shrink, "oracle_power": None}
    return score(PUBLIC, truth, found, **numbers, known=all_effects())


def left(axis, low, significant=True):
    share = interval(low + 0.1645, 0.1)  # its 5 % quantile is `low`
    return Remainder(significant=significant, log10_bayes_factor=3.0, share_of_gap=share, axis=axis)


@pytest.mark.parametrize(
    ("withheld", "found", "expected"),
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
        ([], {"causes": ["viscous"]}, ("viscous", False, True)),
        ([], {"verdict": "unknown", "causes": []}, ("unknown", False, False)),
    ],
)
def test_a_verdict_is_correct_where_it_names_exactly_what_is_there(withheld, found, expected):
    case = judged([effect(name) for name in withheld], gap=0.03 if withheld else 0.0, **found)
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


@pytest.mark.parametrize(("gap", "as_none"), [(0.0049, True), (0.0051, False), (None, False)])
def test_what_is_below_the_practical_share_counts_as_none(gap, as_none):
    found = judged([effect("viscous")], gap=gap, verdict="no-gap", causes=[])
    assert (found.counts_as_none, found.correct) == (as_none, as_none)
    assert (found.noise_free_gap_why is None) == (gap is not None)
    named = judged([effect("viscous")], gap=gap, causes=["viscous"])
    assert named.correct  # it is there, however small
    assert not named.falsely_named
    wrong = judged([effect("viscous")], gap=gap, causes=["stribeck"])
    assert not wrong.correct
    assert wrong.falsely_named


@pytest.mark.parametrize(
    ("found", "flagged"),
    [
        ({"verdict": "unknown", "causes": []}, True),
        ({"remainder": left("order", 0.11)}, True),
        ({"remainder": left("order", 0.09)}, False),  # too small a share
        ({"remainder": left("tension", 0.5)}, False),  # a wrong axis
        ({"remainder": left("order", 0.5, significant=False)}, False),
        ({"verdict": "no-gap", "causes": []}, False),
    ],
)
def test_an_outsider_is_flagged_by_unknown_or_a_remainder_on_a_true_axis(found, flagged):
    case = judged([effect("wave-in-order", own=False, axes=["order", "displacement"])], **found)
    assert case.kind == "outsider"
    assert (case.flagged, case.correct) == (flagged, flagged)


def test_naming_an_effect_for_an_outsider_is_false():
    case = judged([effect("wave-in-order", own=False, axes=["order"])], causes=["wear-drift"])
    assert case.falsely_named


def test_intervals_cover_where_they_hold_the_truth():
    # The sample's slope is 0.123 ± 1.645 · 0.00615, its shrink 0.981 ± 1.645 · 0.004.
    inside = judged([effect("viscous", parameters={"slope": 0.132})], true_shrink=0.986)
    assert (inside.parameters_covered, inside.shrink_covered) == ({"viscous.slope": True}, True)
    outside = judged([effect("viscous", parameters={"slope": 0.134})], true_shrink=0.99)
    assert (outside.parameters_covered, outside.shrink_covered) == ({"viscous.slope": False}, False)
    foreign = judged([effect("viscous", own=False, parameters={"slope": 0.12})])
    assert (foreign.parameters_covered, foreign.shrink_covered) == ({}, None)
    wrong = judged([effect("stribeck", parameters={"slope": 0.12})], true_shrink=0.98)
    assert (wrong.parameters_covered, wrong.shrink_covered) == ({}, None)


def test_the_probability_of_the_truth_is_that_of_its_hypothesis():
    # Of the sample: viscous 0.971, viscous+stribeck 0.0091, unknown 0.002, none 0.0001.
    assert judged([effect("viscous")]).truth_probability == 0.971
    both = [effect("stribeck"), effect("viscous")]
    assert judged(both).truth_probability == 0.0091
    assert judged([effect("wave", axes=["order"])]).truth_probability == 0.002
    assert judged([], gap=0.0).truth_probability == 0.0001

"""The cases of a campaign: how many of each, in which order, with which seeds."""

from collections import Counter
from itertools import combinations

import pytest

from bayesfric.blind.design import INSEPARABLE_CLASSES, Catalogue, cases_from_prior, cases_of
from bayesfric.effects import all_effects
from bayesfric.errors import InputError

EFFECTS = {name: (True, name != "length-scale") for name in all_effects()}
CATALOGUE = Catalogue(EFFECTS, tuple(f"outsider-{k}" for k in range(12)))
WHOLE = 200 + 15 * len(EFFECTS) + 60 + 40


def whole():
    return list(cases_of(CATALOGUE, WHOLE).values())


def test_a_whole_campaign_has_what_was_promised():
    kinds = Counter(case.kind for case in whole())
    assert kinds == {"none": 200, "effect": 15 * len(EFFECTS), "outsider": 60, "pair": 40}
    singles = [case for case in whole() if case.kind == "effect"]
    counts = Counter((case.effects[0], case.form) for case in singles)
    for name, (_, foreign) in EFFECTS.items():
        for strength in (1.0, 0.3):
            own = counts[(name, strength), "own"]
            assert (own, counts[(name, strength), "foreign"]) == ((3, 3) if foreign else (6, 0))
        for strength in (0.1, 0.2, 0.5):
            assert counts[(name, strength), "own"] + counts[(name, strength), "foreign"] == 1
    outsiders = Counter(case.effects[0][0] for case in whole() if case.kind == "outsider")
    assert set(outsiders.values()) == {5}


def test_a_third_of_it_is_a_balanced_sample():
    third = list(cases_of(CATALOGUE, WHOLE // 3).values())
    kinds = Counter(case.kind for case in third)
    for kind, number in Counter(case.kind for case in whole()).items():
        assert kinds[kind] == pytest.approx(number / 3, abs=2)
    full = [c for c in third if c.kind == "effect" and c.effects[0][1] == 1.0]
    assert set(Counter(case.effects[0][0] for case in full).values()) == {2}
    forms = Counter(case.form for case in full)
    assert forms["own"] == pytest.approx(forms["foreign"], abs=2)
    assert third == whole()[: len(third)]
    few = [case.effects[0][0] for case in whole()[:30] if case.kind == "effect"]
    assert len(set(few)) == len(few)


def test_each_case_has_a_seed_of_its_own():
    assert [case.seed for case in whole()] == list(range(10_000, 10_000 + WHOLE))
    assert list(cases_of(CATALOGUE, 2, 17)) == ["000017", "000018"]


def test_no_pair_is_of_one_class():
    pairs = [{name for name, _ in case.effects} for case in whole() if case.kind == "pair"]
    assert len({frozenset(pair) for pair in pairs}) == 40
    assert not any(pair <= alike for pair in pairs for alike in INSEPARABLE_CLASSES)
    two = Catalogue(dict.fromkeys(["clock-scale", "length-scale", "viscous"], (True, True)), ("x",))
    drawn = cases_from_prior(two, 400).values()
    pairs = [{name for name, _ in case.effects} for case in drawn if case.kind == "pair"]
    assert {frozenset(pair) for pair in pairs} == {
        frozenset(p) for p in combinations(two.effects, 2) if set(p) not in INSEPARABLE_CLASSES
    }


def test_tuning_and_scoring_are_apart():
    assert len(cases_of(CATALOGUE, 10, 9_990)) == 10
    with pytest.raises(InputError, match="--seed: found '9990', expected seeds of tuning"):
        cases_of(CATALOGUE, 11, 9_990)
    with pytest.raises(InputError, match="--n: found '0'"):
        cases_of(CATALOGUE, 0)


def test_hypotheses_follow_the_prior():
    kinds = Counter(case.kind for case in cases_from_prior(CATALOGUE, 2000).values())
    assert kinds["none"] / 2000 == pytest.approx(0.5, abs=0.035)  # three standard errors
    assert kinds["effect"] / 2000 == pytest.approx(0.3, abs=0.031)
    assert kinds["pair"] / 2000 == pytest.approx(0.1, abs=0.021)
    strengths = [s for c in cases_from_prior(CATALOGUE, 2000).values() for _, s in c.effects]
    within = sum(s < 0.6745 for s in strengths) / len(strengths)  # median of a half-normal
    assert within == pytest.approx(0.5, abs=0.05)

"""Effects that leave too much of the gap are no causes: an unknown force acts."""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from bayesfric.analysis import Analysis
from bayesfric.diagnosis import judging
from bayesfric.diagnosis.acting import Acting, At
from bayesfric.diagnosis.classes import Classes
from bayesfric.diagnosis.discrepancy import Wide
from bayesfric.diagnosis.forms import FormShare
from bayesfric.diagnosis.hypotheses import Search
from bayesfric.diagnosis.judging import _leaves_too_much, judge
from bayesfric.diagnosis.remainder import all_left
from bayesfric.diagnosis.unknown import Unknown
from bayesfric.diagnosis.weighing import Weighed
from bayesfric.hypothesis import NONE, UNKNOWN, Hypothesis, printed

OWN, REST = np.array([1.0, 1.0, -1.0, -1.0]), np.array([1.0, -1.0, 1.0, -1.0])  # orthogonal


def mean_square(force, taken=0.0):
    """Return mean squares of four windows of one weight."""
    return np.mean((force - taken) ** 2, axis=0)


def judged(shares, labels):
    """Draws of a force of rms 0.1 of friction, of whose square effects leave these shares."""
    shares = np.asarray(shares)
    force = 0.1 * (np.outer(OWN, np.sqrt(1 - shares)) + np.outer(REST, np.sqrt(shares)))
    posterior = SimpleNamespace(
        hypothesis=np.array([Hypothesis.parse(label) for label in labels], dtype=object),
        force=force,
        hidden2=np.zeros(shares.size),
        unresolved2=np.zeros(shares.size),
        gap=np.full(shares.size, 0.1),
    )
    residuals = SimpleNamespace(
        weight=np.full(4, 0.25),
        friction_rms=1.0,
        without_law=lambda column: column,
        mean_square=mean_square,
    )
    arms = SimpleNamespace(
        causes=SimpleNamespace(laws=("viscous",)), of_causes=lambda windows: OWN[:, None]
    )
    return SimpleNamespace(
        residuals=residuals, posterior=posterior, arms=arms, plain=residuals, named=["viscous"]
    )


@pytest.mark.parametrize(
    ("shares", "labels", "practical", "expected"),
    [
        ([0.14, 0.14, 0.14, 0.16], ["viscous"] * 4, 0.02, 0.25),
        ([0.5] * 4, ["viscous"] * 4, 0.02, 1.0),
        ([0.5] * 4, ["viscous"] * 4, 0.08, 0.0),  # 7.1 % of friction, which does not matter
        # Draws in which something else acts say nothing of what viscous friction leaves.
        ([0.5, 0.5, 0.1, 0.1], ["unknown", "slip", "viscous", "slip+viscous"], 0.02, 0.0),
    ],
)
def test_what_is_left_counts_where_it_is_large_and_matters(shares, labels, practical, expected):
    assert _leaves_too_much(judged(shares, labels), practical) == pytest.approx(expected)


@pytest.mark.parametrize(("explained_by_both", "expected"), [(False, 1.0), (True, 0.0)])
def test_what_another_effect_makes_is_not_left_by_the_causes(explained_by_both, expected):
    """Slip makes half of the gap: less sure than viscous friction, and no unknown force."""
    both = np.stack([OWN, REST], axis=1)
    judgement = judged([0.5] * 4, ["slip+viscous"] * 4)
    assert (
        _leaves_too_much(judgement, 0.02, lambda label: both if explained_by_both else None)
        == expected
    )


def test_what_leaves_too_much_counts_as_unknown_with_all_that_holds_it():
    weighed = {
        Hypothesis.parse(name): Weighed(Hypothesis.parse(name).names, value, None, Acting(), AT)
        for name, value in (("none", 0.0), ("viscous", 9.0), ("slip+viscous", 11.0), ("slip", 5.0))
    }
    classes = Classes(members=(("slip",), ("viscous",)), absorbed=(), left_out={})
    priors = Analysis().diagnosis.hypotheses
    plain = Search(weighed, {}, None, classes, priors, np.eye(1), 0.0)
    before = printed(plain.probabilities())
    foreign = {Hypothesis(["viscous"]): 0.75}
    search = Search(weighed, {}, None, classes, priors, np.eye(1), 0.0, foreign)
    moved = printed(search.probabilities())
    for name in ("viscous", "slip+viscous"):
        assert moved[name] == pytest.approx(0.25 * before[name])
    assert moved["slip"] == pytest.approx(before["slip"], rel=1e-15)
    assert moved["unknown"] == pytest.approx(0.75 * (before["viscous"] + before["slip+viscous"]))
    assert sum(moved.values()) == pytest.approx(1.0)
    assert list(moved.values()) == sorted(moved.values(), reverse=True)


@pytest.mark.parametrize(("force", "times"), [(None, 1), ("an unknown force", 2)])
def test_effects_are_judged_again_where_they_leave_too_much(monkeypatch, force, times):
    asked = []

    @dataclass(frozen=True)
    class Once:
        named: list
        arms: object
        plain: object
        residuals: object
        posterior: object

    def once(model, search, shipped, practical, rng):
        asked.append(dict(search.foreign))
        return Once(**vars(judged([0.5] * 4, ["viscous"] * 3 + ["slip"])))

    monkeypatch.setattr(judging, "_judged", once)
    monkeypatch.setattr(judging, "_reshaped", lambda model, hypothesis: None)
    monkeypatch.setattr(judging, "_with_causes", lambda model, force, best: force)
    weighed = {NONE: Weighed((), 0.0, None, Acting(), AT)}
    classes, priors = Classes((), (), {}), Analysis().diagnosis.hypotheses
    search = Search(weighed, {}, force, classes, priors, np.eye(1), 0.0)
    judge(None, search, {}, 0.02, np.random.default_rng(0))
    assert asked == [{}, {frozenset(["viscous"]): 1.0}][:times]


def test_the_remainder_of_an_unknown_force_is_that_force():
    """4.6 nat are two powers of ten; more of the gap than all of it there is not."""
    search = Search(
        {NONE: Weighed((), 1.0, None, Acting(), AT)}, {}, None, None, None, np.eye(1), 0.0
    )
    nodes = Wide(0.1, None), Wide(0.1, "velocity"), Wide(0.1, "tension")
    force = Unknown(nodes, np.log([0.5, 0.1, 0.4]), 1.0 + 2 * np.log(10), AT, Acting())
    remainder = all_left(search, force)
    assert remainder.significant
    assert remainder.log10_bayes_factor == pytest.approx(2.0)
    assert remainder.share_of_gap is None
    assert "no cause is named" in remainder.share_of_gap_why
    assert remainder.axis == "tension"  # of the single ones, where it is along all


NUMBERS = np.zeros(0)
AT = At(NUMBERS, 0.0, None, SimpleNamespace(), NUMBERS, np.zeros((0, 0)), at_mode=True)


def test_an_unknown_force_beside_an_effect_is_as_rare_as_the_effect_is():
    """Sensors surely disagree, and of a force beside that these data say nothing, odds of 1."""
    analysis = Analysis().diagnosis
    effects = tuple((f"effect {number}",) for number in range(20))
    own = Acting()
    weighed = {
        Hypothesis(names): Weighed(names, evidence, np.eye(1), own, AT)
        for names, evidence in (((), -70.0), (("effect 3",), 0.0))
    }
    search = Search(
        weighed, {}, None, Classes(effects, (), {}), analysis.hypotheses, np.eye(1), 0.0
    )
    alone, beside = (Unknown((Wide(0.1, None),), np.zeros(1), v, AT, own) for v in (-70.0, 0.0))
    chances = search.with_unknown(alone, beside, Hypothesis(["effect 3"])).probabilities()
    # One of ten of unknown forces, 0.3 / 0.4 / 20 of which are beside this very effect.
    odds = 0.1 * 0.1 * (0.3 / 0.4 / 20) / (0.3 / 20)
    assert chances[UNKNOWN] == pytest.approx(odds / (1 + odds))


@pytest.mark.parametrize(("with_causes", "kept"), [(5.0, False), (-5.0, True)])
def test_a_force_that_causes_leave_is_beside_them_where_they_are_asked_for(with_causes, kept):
    """Alone it would be drawn at a scatter that takes up what no smooth force is like."""
    alone = Unknown((Wide(0.1, None),), np.zeros(1), 0.0, AT, Acting())
    acting = Acting(shapes=(0.5,))
    best = Weighed(("viscous",), 9.0, None, acting, AT, form=FormShare(0.1))
    asked = []

    def evaluate(*inputs):
        asked.append(inputs)
        return replace(AT, value=with_causes)

    model = SimpleNamespace(full=SimpleNamespace(evaluate=evaluate))
    beside = judging._with_causes(model, alone, best)
    assert asked == [(AT.psi, acting, Wide(0.1, None), {"viscous": FormShare(0.1)})]
    if kept:
        assert beside is alone
    else:
        assert (beside.at.value, beside.acting, beside.form) == (with_causes, acting, best.form)
        assert beside.log_evidence == alone.log_evidence


def test_a_force_that_causes_leave_is_a_remainder():
    """As good as none by itself; with the causes 2 powers of ten better."""
    weighed = {
        NONE: Weighed((), 0.0, None, Acting(), AT),
        Hypothesis(["viscous"]): Weighed(("viscous",), 2 * np.log(10), None, Acting(), AT),
    }
    classes = Classes((("viscous",),), (), {})
    foreign = {Hypothesis(["viscous"]): 1.0}
    priors = Analysis().diagnosis.hypotheses
    search = Search(weighed, {}, None, classes, priors, np.eye(1), 0.0, foreign)
    remainder = all_left(search, Unknown((Wide(0.1, "order"),), np.zeros(1), 0.0, AT, Acting()))
    assert remainder.significant
    assert remainder.log10_bayes_factor == pytest.approx(2.0)


def weighed_by_name(*labels):
    """Return hypotheses, the first the most probable; their effects are columns of a machine."""
    by_names = {}
    for place, label in enumerate(labels):
        names = Hypothesis.parse(label)
        laws = tuple(SimpleNamespace(effect=name) for name in names)
        acting = Acting(laws, (0.0,) * len(laws))
        by_names[names] = Weighed(names.names, -100.0 * place, None, acting, AT)
    return by_names


@pytest.mark.parametrize(
    ("of_spring", "left", "share"),
    [
        (0.05, 0.04, 1.0),  # what is left is as large as what the spring takes
        (0.20, 0.04, None),  # it is a small part of it
        (0.05, 0.01, None),  # it does not matter
        (0.70, 0.40, None),  # gravity makes no nine tenths: both are large
    ],
)
def test_beside_gravity_an_effect_has_to_take_most_of_what_gravity_leaves(
    monkeypatch, of_spring, left, share
):
    """A spring of 5 % of friction beside 4 % that nobody made is as little as that is."""
    weight, spring, rest = np.ones(4), OWN, REST
    force = weight + of_spring * spring + left * rest
    residuals = SimpleNamespace(
        weight=np.full(4, 0.25),
        friction_rms=1.0,
        without_law=lambda column: column,
        mean_square=mean_square,
    )
    posterior = SimpleNamespace(
        hypothesis=np.array([Hypothesis(["gravity-torque", "spring"])] * 3, dtype=object),
        force=np.tile(force[:, None], 3),
        hidden2=np.zeros(3),
        unresolved2=np.zeros(3),
        gap=np.full(3, float(np.sqrt(np.mean(force**2)))),
    )
    arms = SimpleNamespace(
        plain=None, psi=None, of_causes=lambda windows: np.stack([weight, spring], axis=1)
    )
    monkeypatch.setattr(judging, "_around_causes", lambda *inputs: arms)
    monkeypatch.setattr(judging, "residuals_of", lambda *inputs: residuals)
    search = Search(
        weighed_by_name("gravity-torque+spring", "gravity-torque", "none"),
        {},
        None,
        Classes((("gravity-torque",), ("spring",)), (), {}),
        Analysis().diagnosis.hypotheses,
        np.eye(1),
        0.0,
    )
    once = SimpleNamespace(residuals=residuals, posterior=posterior, arms=arms)
    largest = judging._largest_alone(None, search, once, 0.02)
    assert largest == (None if share is None else (Hypothesis(["gravity-torque"]), share))
    if share is not None:
        moved = replace(search, minor=largest)
        assert moved.probabilities()[Hypothesis(["gravity-torque"])] == pytest.approx(1.0)
        assert moved.best().names == ("gravity-torque",)

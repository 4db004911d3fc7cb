"""Held-out data judge causes together with the best of the effects that nobody can tell apart."""

from types import SimpleNamespace

import numpy as np
import pytest
from report.diagnosis_sample import diagnosis

from bayesfric.analysis import Analysis
from bayesfric.diagnosis import concluded, measured, search
from bayesfric.diagnosis.acting import Acting
from bayesfric.diagnosis.classes import Classes
from bayesfric.diagnosis.hypotheses import Search
from bayesfric.diagnosis.measured import best_beside, measure
from bayesfric.diagnosis.search import Steps, _weigh_exchanged
from bayesfric.diagnosis.verdict import KnownEffect
from bayesfric.diagnosis.weighing import Weighed
from bayesfric.hypothesis import Hypothesis

GRAVITY, BY_DIRECTION, BY_SPEED = "gravity-torque", "direction-asymmetry", "viscous-asymmetry"
WITH_DIRECTION = Hypothesis((GRAVITY, BY_DIRECTION))
WITH_SPEED = Hypothesis((GRAVITY, BY_SPEED))
EVIDENCES = {
    Hypothesis(): -90.0,
    Hypothesis((GRAVITY,)): -20.0,
    WITH_DIRECTION: 0.0,
    WITH_SPEED: 0.2,
}
LEFT = 0.04  # N that held-out data leave of gravity alone


def searched(evidences, doubted=()):
    """Return hypotheses with these log evidences."""
    at = SimpleNamespace(psi=np.zeros(2))
    weighed = {
        hypothesis: Weighed(hypothesis.names, value, None, Acting(), at)
        for hypothesis, value in evidences.items()
    }
    members = tuple((name,) for name in (BY_DIRECTION, GRAVITY, "spring", BY_SPEED))
    classes = Classes(members=members, absorbed=(), left_out={})
    priors = Analysis().diagnosis.hypotheses
    return Search(weighed, {}, None, classes, priors, np.eye(1), 0.0, doubted=frozenset(doubted))


def judged(hypotheses, named=(GRAVITY,)):
    """Return effects with their probabilities, of which some are causes."""
    chances = hypotheses.probabilities()
    effects_known = [
        KnownEffect(name, sum(p for acting, p in chances.items() if name in acting), 1.0, 0.1)
        for name in (GRAVITY, BY_DIRECTION, BY_SPEED)
    ]
    arms = SimpleNamespace(predicting=frozenset(named), like_clocks=lambda _: False)
    return SimpleNamespace(
        search=hypotheses,
        named=list(named),
        effects_known=effects_known,
        arms=arms,
        plain=None,
        posterior=None,
        residuals=None,
    )


def test_the_best_of_the_effects_that_are_not_told_apart_predicts_beside_a_cause():
    best, predicting = best_beside(judged(searched(EVIDENCES)))
    assert best.hypothesis == predicting == WITH_SPEED
    less = searched({**EVIDENCES, WITH_SPEED: -0.2})
    assert best_beside(judged(less))[1] == WITH_DIRECTION
    doubted = {acting.with_effects("spring"): 9.0 for acting in (WITH_DIRECTION, WITH_SPEED)}
    assert best_beside(judged(searched(EVIDENCES | doubted, ["spring"])))[1] == WITH_SPEED


def test_nothing_predicts_beside_a_cause_that_acts_alone_or_where_there_is_no_cause():
    alone = {**EVIDENCES, Hypothesis((GRAVITY,)): 20.0}
    assert best_beside(judged(searched(alone))) is None
    assert best_beside(judged(searched(EVIDENCES), named=())) is None


@pytest.mark.parametrize("gain", [0.2, 9.0])
def test_a_cause_is_judged_beside_the_best_and_stored_with_its_own_shrink(monkeypatch, gain):
    """With 9 nat one asymmetry is certain: it is weak here and no cause, and nothing is open."""

    def gap_of(predicting, *_):
        left = 0.0 if BY_SPEED in predicting else LEFT
        after = diagnosis().gap.after.model_copy(update={"q50": left})
        return diagnosis().gap.model_copy(update={"held_out_excess": left, "after": after}), None

    def arms_with(model, weighed, names, like):
        return SimpleNamespace(predicting=frozenset(names), plain=None, psi=None)

    monkeypatch.setattr(measured, "measure_gap", lambda arms, *_: arms.predicting)
    monkeypatch.setattr(measured, "gap_of", gap_of)
    monkeypatch.setattr(measured, "arms_with", arms_with)
    monkeypatch.setattr(measured, "residuals_of", lambda *_: None)
    monkeypatch.setattr(measured, "block_densities", lambda *_: None)
    monkeypatch.setattr(measured, "share_of_friction", lambda *_: {})
    question = SimpleNamespace(practical=0.02)
    compared = SimpleNamespace(model=None, data=SimpleNamespace(unit="N"))
    own = judged(searched({**EVIDENCES, WITH_SPEED: gain}))
    keeping = SimpleNamespace(record=lambda name, kind, compute: compute())
    sources = np.random.default_rng(1).spawn(3)
    result = measure(question, compared, own, keeping, *sources)
    is_open = gain < 1
    assert result.beside == ({BY_SPEED} if is_open else set())
    assert result.judging.held_out_excess == (0.0 if is_open else LEFT)
    assert result.gap.held_out_excess == result.judging.held_out_excess
    assert result.gap.after.q50 == LEFT


def test_a_rule_that_overrules_names_what_predicted_beside_the_causes(monkeypatch):
    monkeypatch.setattr(concluded, "why_overruled", lambda *_, **__: "so and so")
    monkeypatch.setattr(concluded, "accounts_for_residual", lambda *_: False)
    model = SimpleNamespace(data=SimpleNamespace(rigs=[SimpleNamespace(along_path=False)]))
    remainder = SimpleNamespace(significant=False)
    for beside, words in (((BY_SPEED,), f"with {BY_SPEED} beside, so and so"), ((), "so and so")):
        judging = SimpleNamespace(judging=None, beside=Hypothesis(beside))
        assert concluded._why_overruled(model, None, judging, 0.02, remainder) == words


@pytest.mark.parametrize(("first_look", "expected"), [(-7.0, True), (-9.0, False)])
def test_an_effect_of_the_best_is_exchanged_for_another_at_the_noise_of_the_best(
    monkeypatch, first_look, expected
):
    """The look of both is 300 nat too low: their difference alone decides."""
    rough = {WITH_DIRECTION: -300.0, WITH_SPEED: -300.0 + first_look}
    asked = []

    def extended(model, part, joining, psi, shapes, forms):
        asked.append(part.names)
        return dict(rough)

    def weigh(model, names, *_, **__):
        return Weighed(names, 0.5, None, Acting(), None)

    monkeypatch.setattr(search, "_extended", extended)
    evidences = {acting: value for acting, value in EVIDENCES.items() if acting != WITH_SPEED}
    result = searched({**evidences, Hypothesis((BY_DIRECTION,)): -60.0})
    _weigh_exchanged(None, result, Steps(weigh, None))
    assert (WITH_SPEED in result.weighed) is expected
    assert set(asked) == {(GRAVITY,), (BY_DIRECTION,)}


def test_an_effect_that_acts_alone_is_not_exchanged(monkeypatch):
    monkeypatch.setattr(search, "_extended", None)
    result = searched({Hypothesis(): -90.0, Hypothesis((GRAVITY,)): 0.0})
    _weigh_exchanged(None, result, Steps(None, None))
    assert len(result.weighed) == 2

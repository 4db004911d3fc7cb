"""Compares hypotheses in a model linearised around the baseline.

The best are compared again in a model linearised around the law of the leading hypothesis.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bayesfric.arrays import Array
from bayesfric.checkpoint import Checkpoint
from bayesfric.diagnosis.acting import Acting, At
from bayesfric.diagnosis.baseline import fitted_baseline
from bayesfric.diagnosis.classes import classes_of
from bayesfric.diagnosis.climbing import climb, curvature_at
from bayesfric.diagnosis.forms import other_forms
from bayesfric.diagnosis.hypotheses import Search
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.nearby import around_nearby
from bayesfric.diagnosis.question import Question
from bayesfric.diagnosis.search import Steps, compare, search
from bayesfric.diagnosis.squeezing import squeezed
from bayesfric.diagnosis.strays import without_strays
from bayesfric.diagnosis.unknown import Unknown, unknown_force
from bayesfric.diagnosis.weighing import Weighed, weigh
from bayesfric.diagnosis_rules import RULES
from bayesfric.effects.candidates import Candidate
from bayesfric.hypothesis import NONE
from bayesfric.rigs.data import Data

ROUNDS = 4  # linearisations around the law that was fitted with the leader


@dataclass(frozen=True)
class Compared:
    """The result of comparing hypotheses.

    Parameters
    ----------
    data : Data
        Trials without strays.
    stray : tuple of str
        The stray trials, with the reason.
    psi : ndarray
        Logarithms of the noise parameters of the baseline alone.
    baseline : LinearModel
        Model around the law that was fitted without effects.
    first : Search
        Hypotheses in that model, which contains every effect.
    model : LinearModel
        Model around the law that was fitted with the leading hypothesis.
    search : Search
        The finalists in that model.
    """

    data: Data
    stray: tuple[str, ...]
    psi: Array
    baseline: LinearModel
    first: Search
    model: LinearModel
    search: Search


def compare_hypotheses(question: Question, keeping: Checkpoint) -> Compared:
    """Compare all hypotheses; slow steps are stored in a checkpoint.

    Parameters
    ----------
    question : Question
        The recording and what is asked of it.
    keeping : Checkpoint
        Stores the slow steps.
    """
    # Checkpoints with other priors have other names.
    wide = "".join(f"{name}-" for name in question.widened)
    climbing = keeping.keep_each_call(f"{wide}climb", At, climb)
    steps = Steps(
        keeping.keep_each_call(f"{wide}weigh", Weighed, weigh),
        keeping.keep_each_call(f"{wide}unknown", Unknown | None, unknown_force),
    )
    analysis, held, law = question.analysis, question.held, question.law
    data, stray, laws, psi = fitted_baseline(
        question.data, analysis, held, question.law_shipped, law, climbing
    )
    candidates = question.candidates
    whole = LinearModel(data, laws, candidates, analysis, held | frozenset(law.without))

    def looked_at(model: LinearModel) -> tuple[LinearModel, Search]:
        around = squeezed(model, psi)
        at = climbing(around, psi, Acting())
        around = around.reweighted(at.psi, Acting())
        return around, _first_look(around, at, steps)

    def with_weights(weights: Mapping[str, Array]) -> tuple[LinearModel, Search]:
        return looked_at(baseline.full.around(laws, candidates, row_weights=weights))

    baseline, first = looked_at(whole)
    baseline, first = without_strays(baseline, first, with_weights)
    return Compared(data, stray, psi, baseline, first, *_finals(baseline, first, steps))


def _first_look(model: LinearModel, at: At, steps: Steps) -> Search:
    """Evaluate all hypotheses around the baseline."""
    classes = classes_of(model, at.psi)
    model.merge(classes.members)
    curvature = curvature_at(model, at, Acting())
    inverse = np.asarray(np.linalg.inv(curvature), dtype=np.float64)
    none = steps.weigh(model, (), [at.psi], inverse, 0.0)
    return search(model, none, inverse, 0.0, classes, steps)


def _finals(first: LinearModel, searched: Search, steps: Steps) -> tuple[LinearModel, Search]:
    """Compare the finalists in one model, around the law fitted with the leading hypothesis."""
    model = first
    if searched.probabilities().get(NONE, 0.0) > RULES.sure:
        # No effect is large enough to change the law: the first comparison stands.
        return _with_best_weights(model, searched), searched
    for _ in range(ROUNDS):
        leader = searched.best()
        acting = model.amplitudes(leader.at, leader.acting)
        forms = other_forms([rig.rows for rig in model.rigs], _acting_once(model, searched))
        model = _with_best_weights(model, searched)
        around, is_last_step = around_nearby(
            model,
            model.fitted_laws(leader.at),
            first.candidates,
            scattering=acting,
            forms=forms,
        )
        around.merge(searched.classes.members)
        around = squeezed(around, leader.at.psi)
        model, searched = around, compare(around, searched, steps)
        if is_last_step and searched.best().names == leader.names:
            break
    return _with_best_weights(model, searched), searched


def _with_best_weights(model: LinearModel, searched: Search) -> LinearModel:
    """Return the model with the weights of Student-t deviations under the best hypothesis."""
    best = searched.best()
    return model.reweighted(best.at.psi, best.acting, None, best.forms)


def _acting_once(model: LinearModel, searched: Search) -> list[tuple[Candidate, float]]:
    """Return each effect of the likeliest hypotheses, as in the best hypothesis with it."""
    ranked = sorted(searched.weighed.values(), key=lambda weighed: -searched.worth(weighed))
    top = searched.worth(ranked[0])
    acting: dict[str, tuple[Candidate, float]] = {}
    for weighed in ranked:
        if searched.worth(weighed) < top - RULES.followed_within:
            break
        for candidate, amplitude in model.amplitudes(weighed.at, weighed.acting):
            acting.setdefault(candidate.effect.name, (candidate, amplitude))
    return list(acting.values())

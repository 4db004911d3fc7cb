"""What a recording can determine, given its own noise and linearised around its own law.

The computation uses the hypotheses that a diagnosis compares, each with its discrepancy. So it
predicts what a diagnosis will find: an effect has to win against no effect, and against every other
effect that would explain most of its force.
"""

from collections.abc import Mapping
from dataclasses import replace
from math import comb, log
from typing import NamedTuple

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from bayesfric.analysis import Prior
from bayesfric.arrays import Array, Flags
from bayesfric.checkpoint import Checkpoint
from bayesfric.claims.comparison import FOUND_WITH
from bayesfric.diagnosis.acting import Acting, Law
from bayesfric.diagnosis.baseline import fitted_baseline
from bayesfric.diagnosis.compared import Compared, compare_hypotheses
from bayesfric.diagnosis.gravity import by_gravity, gravity_hides_inertia
from bayesfric.diagnosis.judging import Judged, judge
from bayesfric.diagnosis.law import FRICTION, scatter_of_runs
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.question import Question
from bayesfric.diagnosis.systematic import inclusion
from bayesfric.diagnosis.weighing import Weighed
from bayesfric.diagnosis.widening import MASS
from bayesfric.diagnosis_rules import RULES
from bayesfric.effects.candidates import Candidate, candidates_of
from bayesfric.inference.power import (
    LEAST_PRECISION_RATIO,
    smallest_found,
    smallest_told_apart,
)
from bayesfric.planning import Power, model_of_middles, power_of_model, share_of_friction

HIDDEN_WITH = 0.01  # an effect that is found with a lower probability counts as hidden
USUAL_SHAPES = 1.0  # shapes lie within these normal quantiles of their prior
LEAST_GAINED = 1.0  # nat, least gain of an effect of the most probable hypothesis
SURE_ODDS = log(RULES.sure / (1 - RULES.sure))  # nat


def numbers_told(question: Question) -> Power:
    """Return the errors with which a recording determines the numbers of its law, and nothing else.

    Parameters
    ----------
    question : Question
        What a diagnosis of one joint would be asked.
    """
    analysis, law = question.analysis, question.law
    with threadpool_limits(limits=1):
        data, _, laws, psi = fitted_baseline(question.data, analysis, frozenset(), {}, law)
        model = LinearModel(data, laws, (), analysis, frozenset(law.without), discrepancy=False)
        return power_of_model(model, {}, analysis, psi, pd.DataFrame())


def power_of_measured(question: Question) -> Power:
    """Return what a recording can determine, given its own noise and around its own law.

    If the law lacks an effect, the noise that is fitted with the law alone absorbs the effect. So
    noise and errors are estimated together with the effects that a first look finds, as in the
    diagnosis. Coefficients also have ``sd_where_law_is_off``: their errors if the law is wrong by
    the practical share of friction, as a diagnosis reports them. Effects also have ``unseen``: the
    amplitude below which a diagnosis names the effect less than once in a hundred times.

    Parameters
    ----------
    question : Question
        What a diagnosis of one joint would be asked.
    """
    with threadpool_limits(limits=1):
        look = _first_look(question)
        tellable = power_of_model(
            look.noise_alone, look.missing, question.analysis, look.psi, shown=look.places
        )
        sources, compared = question.sources, look.compared
        judged = judge(
            compared.model,
            compared.search,
            question.law_shipped,
            question.practical,
            sources.draws,
        )
        spread = _spread_of_law(compared, judged, sources.scatter)
        hides = gravity_hides_inertia(compared.model, judged.residuals.turns)
        for factor, _ in by_gravity(hides, judged.named).values():
            spread[MASS] *= factor
        numbers = tellable.coefficients
        return replace(
            tellable,
            coefficients=numbers.assign(
                # A recalibrated law may have smaller errors than its numbers have beside an effect.
                sd_where_law_is_off=[max(spread[n], numbers.loc[n, "sd"]) for n in numbers.index]
            ),
            effects=_effects(look, inclusion(judged.search)),
            beside=tuple(effect for effect, _ in look.shown),
        )


class _Shown(NamedTuple):
    """A law of an effect that acts in a hypothesis, with its best shape and amplitude.

    The name is that in the hypothesis, which may be the name of an identical effect.
    """

    shape: float
    amplitude: float
    name: str


class _Look(NamedTuple):
    """The results of a first comparison of hypotheses.

    Parameters
    ----------
    compared : Compared
        Hypotheses, as a diagnosis compares them.
    shown : dict of (str, str) to _Shown
        Effects that act in the most probable hypothesis, by effect and law.
    alone : dict of (str, str) to _Shown
        Effects that act alone in other hypotheses, by effect and law.
    psi : ndarray
        Logarithms of the noise parameters beside them.
    model : LinearModel
        The model around the estimated law, with each law of each effect at all its shapes.
    noise_alone : LinearModel
        The same with each law at one shape, and without discrepancy.
    places : tuple of int
        Indices of the shown effects among its candidates.
    missing : dict of str to str
        Effects that could not be examined, with the reason.
    """

    compared: Compared
    shown: dict[tuple[str, str], _Shown]
    alone: dict[tuple[str, str], _Shown]
    psi: Array
    model: LinearModel
    noise_alone: LinearModel
    places: tuple[int, ...]
    missing: dict[str, str]


def _first_look(question: Question) -> _Look:
    """Compare hypotheses as a diagnosis does, without held-out data."""
    compared = compare_hypotheses(question, Checkpoint(None, ""))
    around, best = compared.model, compared.search.best()
    shown = _shown_by(around, best)
    alone: dict[tuple[str, str], _Shown] = {}
    for weighed in compared.search.weighed.values():
        if len(weighed.names) == 1:
            alone |= _shown_by(around, weighed)
    middle, missing = model_of_middles(
        compared.data, around.laws, question.analysis, frozenset(question.law.without)
    )
    at_best = {
        (law.effect, law.law): around.candidate(law, shape)
        for law, shape in zip(best.acting.laws, best.acting.shapes, strict=True)
    }
    candidates: list[Candidate] = [
        at_best.get((own.effect.name, own.law), own) for own in middle.candidates
    ]
    effects = {candidate.effect.name: candidate.effect for candidate in candidates}
    shapes = [candidate for effect in effects.values() for candidate in candidates_of(effect)]
    return _Look(
        compared,
        shown,
        alone,
        best.at.psi[: len(around.noise)],
        middle.around(around.laws, shapes),
        middle.around(around.laws, candidates, discrepancy=False),
        tuple(
            place for place, own in enumerate(candidates) if (own.effect.name, own.law) in at_best
        ),
        missing,
    )


def _shown_by(model: LinearModel, weighed: Weighed) -> dict[tuple[str, str], _Shown]:
    """Return the effects that act in a hypothesis, by effect and law."""
    acting, fitted = weighed.acting, model.amplitudes(weighed.at, weighed.acting)
    return {
        (law.effect, law.law): _Shown(
            shape, amplitude, next(name for name in weighed.names if law in model.lawbook[name])
        )
        for law, shape, (_, amplitude) in zip(acting.laws, acting.shapes, fitted, strict=True)
    }


def _known_by_data(precision: Array, law: Law, shape: float) -> float:
    """Return the precision of an amplitude from the data over that of its prior."""
    weights, places = law.weights(np.asarray(shape)), list(law.places)
    return float(weights @ precision[np.ix_(places, places)] @ weights)


def _odds_of_the_first(model: LinearModel) -> float:
    """Return the log Bayes factor above which a diagnosis names an effect [nat]."""
    prior = model.analysis.diagnosis.hypotheses
    return SURE_ODDS + log(prior.none) - log(prior.one) + log(comb(len(model.lawbook), 1))


def _spread_of_law(
    compared: Compared, judged: Judged, rng: np.random.Generator
) -> dict[str, float]:
    """Return the error of each number of the law, if the law may be wrong, by name.

    It is the error that a diagnosis reports, from the same draws: over all hypotheses that remain
    possible, and over future runs.
    """
    model, drawn, plain = compared.model, judged.posterior.law.coefficients, judged.plain
    arms, in_none = judged.arms, np.zeros(plain.setup.size, dtype=np.bool_)
    *_, with_causes = arms.fitted(arms.with_discrepancy(plain, []), plain, in_none)
    scatter = scatter_of_runs(model, plain, plain.left(with_causes.local))
    deviation = np.zeros(len(drawn))
    if scatter is not None:
        deviation = scatter.deviations(len(drawn), rng)
    return {
        name: float((drawn[:, place, column] * (1 + deviation * (name in FRICTION))).std())
        for place, size in enumerate(model.layout.sizes)
        for column, (name, _) in enumerate(model.data.law_numbers(size))
    }


def _effects(look: _Look, chances: Mapping[str, float]) -> pd.DataFrame:
    """Return the amplitude above which each law of each effect is named, and below which it is not.

    For an effect that acts in the most probable hypothesis, or that is possible, its probability in
    `chances` says whether it is named at its amplitude there. Scatter or an unknown force may
    explain it instead.
    """
    model = look.model
    precision = model.reduced(look.psi, Acting()).precision
    odds = _odds_of_the_first(model)
    rows = {}
    for law in (law for laws in model.lawbook.values() for law in laws):
        shown = look.shown.get((law.effect, law.law))
        at = 0.0 if shown is None else shown.shape
        amplitude = model.analysed(law.effect).amplitude
        shapes = (at, -USUAL_SHAPES, USUAL_SHAPES) if law.has_shape else (at,)
        errors = [_errors(model, precision, law, shape) for shape in shapes]
        if not np.isfinite(errors[0][0]):
            continue
        named, unnamed = (
            [_named_from(*of_shape, amplitude.prior, odds, probability) for of_shape in errors]
            for probability in (FOUND_WITH, HIDDEN_WITH)
        )
        smallest, unseen = named[0], min(unnamed)
        there = shown or look.alone.get((law.effect, law.law))
        if there is not None:
            size, chance = abs(there.amplitude), chances.get(there.name, 0.0)
            if chance >= RULES.sure:
                smallest, unseen = min(smallest, size), min(unseen, size)
            elif shown is not None or chance >= RULES.possible:
                smallest = max(smallest, _told_from(size, chance, odds))
        rows[f"{law.effect}/{law.law}"] = {
            "smallest": smallest,
            "unseen": unseen,
            "unit": amplitude.unit,
            "share": share_of_friction(model, model.candidate(law, at), smallest),
        }
    return pd.DataFrame.from_dict(rows, orient="index")


def _errors(model: LinearModel, precision: Array, law: Law, shape: float) -> tuple[float, float]:
    """Return the error of an effect's amplitude, alone and beside its strongest rival.

    Both are infinite if the data do not inform the amplitude.
    """
    informed = _known_by_data(precision, law, shape)
    across = law.weights(np.asarray(shape)) @ precision[list(law.places)]
    if 1 + informed < LEAST_PRECISION_RATIO:
        return np.inf, np.inf
    rivals: Flags = np.array(
        [
            abs(rival.node) <= USUAL_SHAPES and rival.effect.name != law.effect and said > 0
            for rival, said in zip(model.candidates, np.diag(precision), strict=True)
        ]
    )
    alike = across[rivals] ** 2 / (informed * np.diag(precision)[rivals])
    alike = alike[alike < RULES.effects_alike**2]  # identical effects are one class
    error = model.amplitude_scale(law) / float(np.sqrt(informed))
    return error, error / float(np.sqrt(1 - alike.max(initial=0.0)))


def _named_from(
    error: float, beside: float, prior: Prior, odds: float, probability: float
) -> float:
    """Return the amplitude that is named with a given probability, against none and any rival."""
    if not np.isfinite(error):
        return np.inf
    return max(
        smallest_found(error, prior, odds, probability),
        smallest_told_apart(beside, SURE_ODDS, probability),
    )


def _told_from(amplitude: float, chance: float, odds: float) -> float:
    """Return the amplitude that would be named, from an amplitude that is shown but not certain.

    Parameters
    ----------
    amplitude : float
        The amplitude that is shown. The log Bayes factor is proportional to its square.
    chance : float
        Probability of the effect.
    odds : float
        Log Bayes factor above which a diagnosis names the effect [nat].
    """
    bounded = min(max(chance, RULES.rare), RULES.sure)
    gained = odds - SURE_ODDS + log(bounded / (1 - bounded))
    error = amplitude / float(np.sqrt(2 * max(gained, LEAST_GAINED)))
    return smallest_told_apart(error, odds, FOUND_WITH)

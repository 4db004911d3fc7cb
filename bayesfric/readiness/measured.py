"""What a recording can tell, by the noise and around the law that it shows.

It is asked of the hypotheses that a diagnosis compares, each with its discrepancy, so that what
is said beforehand is what a diagnosis will find: an effect has to win against none, and against
every other effect that would take most of what it does.
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

HIDDEN_WITH = 0.01  # the probability with which an effect is found below which none is expected
USUAL_SHAPES = 1.0  # normal quantiles of a shape's prior, within which rivals and doubles lie
LEAST_GAINED = 1.0  # nat, that an effect of the most probable hypothesis is worth
SURE_ODDS = log(RULES.sure / (1 - RULES.sure))  # nat


def numbers_told(question: Question) -> Power:
    """Return with which errors a recording tells the numbers of its law, and nothing else.

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
    """Return what a recording can tell, with the noise and around the law that it shows.

    Where the law lacks an effect, the noise that is fitted beside the law alone takes up what that
    effect does. So noise and errors are those beside the effects that a first look shows, as in
    the diagnosis. Coefficients have ``sd_where_law_is_off`` too: their errors where the law may be
    wrong by the share of friction below which no gap counts, as a diagnosis states them. Effects
    have ``unseen`` too: the amplitude below which a diagnosis names it once in a hundred times.

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
                # A recalibrated law may be known better than its numbers beside an effect's.
                sd_where_law_is_off=[max(spread[n], numbers.loc[n, "sd"]) for n in numbers.index]
            ),
            effects=_effects(look, inclusion(judged.search)),
            beside=tuple(effect for effect, _ in look.shown),
        )


class _Shown(NamedTuple):
    """A law of an effect that acts in a hypothesis: its best shape and amplitude.

    The name is the one that the effect has there, which may be that of an identical one.
    """

    shape: float
    amplitude: float
    name: str


class _Look(NamedTuple):
    """What a first look shows.

    Parameters
    ----------
    compared : Compared
        Hypotheses, as a diagnosis compares them.
    shown : dict of (str, str) to _Shown
        By effect and law: what acts in the most probable hypothesis.
    alone : dict of (str, str) to _Shown
        The same of effects that act alone in other hypotheses.
    psi : ndarray
        Logarithms of the noise beside them.
    model : LinearModel
        Around the law that the measurements show, with each law of each effect at all its shapes.
    noise_alone : LinearModel
        The same with each law at one shape, and without discrepancy.
    places : tuple of int
        Among its candidates, what is shown.
    missing : dict of str to str
        Effects that nothing is said of, with the reason.
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
    """Compare hypotheses as a diagnosis does, before anything is held out."""
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
    """Return what acts in a hypothesis, by effect and law."""
    acting, fitted = weighed.acting, model.amplitudes(weighed.at, weighed.acting)
    return {
        (law.effect, law.law): _Shown(
            shape, amplitude, next(name for name in weighed.names if law in model.lawbook[name])
        )
        for law, shape, (_, amplitude) in zip(acting.laws, acting.shapes, fitted, strict=True)
    }


def _known_by_data(precision: Array, law: Law, shape: float) -> float:
    """Return the precision with which data know an amplitude, over that of its prior."""
    weights, places = law.weights(np.asarray(shape)), list(law.places)
    return float(weights @ precision[np.ix_(places, places)] @ weights)


def _odds_of_the_first(model: LinearModel) -> float:
    """Return the log Bayes factor from which on a diagnosis is sure of an effect [nat]."""
    prior = model.analysis.diagnosis.hypotheses
    return SURE_ODDS + log(prior.none) - log(prior.one) + log(comb(len(model.lawbook), 1))


def _spread_of_law(
    compared: Compared, judged: Judged, rng: np.random.Generator
) -> dict[str, float]:
    """Return the error of each number of the law where the law may be off, by name.

    It is that of a diagnosis, by the same draws: over all hypotheses that stay open, and over runs
    to come.
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
    """Return from which amplitude on each law of each effect is named, and below which not.

    Of an effect that acts in the most probable hypothesis, or that is possible, the data say
    themselves whether it is told at the amplitude that it has there: by its probability, in
    `chances`. Scatter, or an unknown force, may take its place.
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
    """Return the error of an effect's amplitude, alone and beside the rival that takes most of it.

    Both are infinite where the data leave the amplitude to its prior.
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
    alike = alike[alike < RULES.effects_alike**2]  # what is identical is one class
    error = model.amplitude_scale(law) / float(np.sqrt(informed))
    return error, error / float(np.sqrt(1 - alike.max(initial=0.0)))


def _named_from(
    error: float, beside: float, prior: Prior, odds: float, probability: float
) -> float:
    """Return the amplitude that is named with a probability, against none and any rival."""
    if not np.isfinite(error):
        return np.inf
    return max(
        smallest_found(error, prior, odds, probability),
        smallest_told_apart(beside, SURE_ODDS, probability),
    )


def _told_from(amplitude: float, chance: float, odds: float) -> float:
    """Return the amplitude at which data are sure of what they show, but not surely.

    Parameters
    ----------
    amplitude : float
        That it has, whose square the log Bayes factor goes with.
    chance : float
        Of the effect.
    odds : float
        Log Bayes factor at which a diagnosis is sure [nat].
    """
    bounded = min(max(chance, RULES.rare), RULES.sure)
    gained = odds - SURE_ODDS + log(bounded / (1 - bounded))
    error = amplitude / float(np.sqrt(2 * max(gained, LEAST_GAINED)))
    return smallest_told_apart(error, odds, FOUND_WITH)

"""What a recording can tell, by the noise and around the law that it shows.

It is asked of the hypotheses that a diagnosis compares, each with its discrepancy, so that what
is said beforehand is what a diagnosis will find: an effect has to win against none, and against
every other effect that would take most of what it does.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import comb, log
from typing import NamedTuple

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from bayesfric.analysis import Analysis, Prior
from bayesfric.arrays import Array, Flags
from bayesfric.claims.comparison import FOUND_WITH
from bayesfric.diagnosis.acting import Acting, Law
from bayesfric.diagnosis.baseline import fitted_baseline
from bayesfric.diagnosis.climbing import climb
from bayesfric.diagnosis.law import FRICTION, scatter_of_runs
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.residuals import residuals_of, spread_numbers
from bayesfric.diagnosis.shapes import Quadratic
from bayesfric.diagnosis.systematic import drawn_laws
from bayesfric.diagnosis.weighing import Weighed
from bayesfric.diagnosis_rules import RULES
from bayesfric.effects.candidates import Candidate, candidates_of
from bayesfric.inference.power import (
    LEAST_PRECISION_RATIO,
    smallest_found,
    smallest_told_apart,
)
from bayesfric.physics.laws import FrictionLaw
from bayesfric.planning import Power, model_of_middles, power_of_model
from bayesfric.rigs.data import Data
from bayesfric.rigs.opening import with_own_priors

HIDDEN_WITH = 0.01  # the probability with which an effect is found below which none is expected
USUAL_SHAPES = 1.0  # normal quantiles of a shape's prior, within which rivals and doubles lie
LEAST_INFORMED = 3.0  # precision by the data over that of a prior, of an effect that may join
DRAWS = 400
SURE_ODDS = log(RULES.sure / (1 - RULES.sure))  # nat


def power_of_measured(
    data: Data,
    law: FrictionLaw,
    analysis: Analysis | None = None,
    *,
    numbers_alone: bool = False,
) -> Power:
    """Return what a recording can tell, with the noise and around the law that it shows.

    Where the law lacks an effect, the noise that is fitted beside the law alone takes up what that
    effect does. So noise and errors are those beside the effects that a first look shows, as in
    the diagnosis. Coefficients have ``sd_where_law_is_off`` too: their errors where the law may be
    wrong by the share of friction below which no gap counts, as a diagnosis states them. Effects
    have ``unseen`` too: the amplitude below which a diagnosis names it once in a hundred times.

    Parameters
    ----------
    data : Data
        Of one joint.
    law : FrictionLaw
        Of friction, as of a diagnosis.
    analysis : Analysis or None
        Priors.
    numbers_alone : bool
        Whether effects and next trials are left out, which takes most of the time.
    """
    analysis = with_own_priors(Analysis() if analysis is None else analysis, data.rigs)
    with threadpool_limits(limits=1):
        data, _, laws, psi = fitted_baseline(data, analysis, frozenset(), {}, law)
        held = frozenset(law.without)
        if numbers_alone:
            model = LinearModel(data, laws, (), analysis, held, discrepancy=False)
            return power_of_model(model, {}, analysis, psi, pd.DataFrame())
        middle, missing = model_of_middles(data, laws, analysis, held)
        look = _first_look(middle, psi)
        acting = look.acting
        shown = {
            (law.effect, law.law): look.model.candidate(law, shape)
            for law, shape in zip(acting.laws, acting.shapes, strict=True)
        }
        candidates = [shown.get((own.effect.name, own.law), own) for own in middle.candidates]
        noise_alone = middle.around(look.model.laws, candidates, discrepancy=False)
        places = [candidates.index(candidate) for candidate in shown.values()]
        tellable = power_of_model(noise_alone, missing, analysis, look.psi, shown=places)
        spread = _spread_of_law(look)
        numbers = tellable.coefficients
        return replace(
            tellable,
            coefficients=numbers.assign(
                sd_where_law_is_off=[spread[name] for name in numbers.index]
            ),
            effects=_effects(look),
            beside=tuple(law.effect for law in acting.laws),
        )


class _Look(NamedTuple):
    """What a first look shows.

    Parameters
    ----------
    model : LinearModel
        Around the law that the measurements show.
    acting : Acting
        Effects of which a diagnosis would be sure, each with its best shape.
    psi : ndarray
        Logarithms of the noise beside them.
    open_for : dict of Acting to float
        Hypotheses that stay open, these effects among them, with their log odds [nat].
    """

    model: LinearModel
    acting: Acting
    psi: Array
    open_for: dict[Acting, float]


def _first_look(middle: LinearModel, psi: Array) -> _Look:
    """Return what the measurements show.

    One effect after another joins; each time the law is fitted and the noise is climbed anew.
    Effects whose amplitudes are left to their priors do not.
    """
    effects = {candidate.effect.name: candidate.effect for candidate in middle.candidates}
    shapes = [candidate for effect in effects.values() for candidate in candidates_of(effect)]
    model, acting = middle.around(middle.laws, shapes), Acting()
    rivals: dict[Acting, float] = {}
    while True:
        form = Quadratic(model, model.reduced(psi, Acting()), range(len(shapes)))
        held = _gain(form, acting.laws, acting.shapes)
        precision = form.reduced.precision
        worth = {
            law: law.log_weight + _gain(form, (*acting.laws, law), (*acting.shapes, 0.0)) - held
            for laws in model.lawbook.values()
            for law in laws
            if law.effect not in acting.names
            and _known_by_data(precision, law, 0.0) > LEAST_INFORMED
        }
        best = max(worth, key=lambda law: worth[law], default=None)
        odds = _odds_of_one_more(model, len(acting.laws))
        joins = best is not None and worth[best] >= odds and len(acting.laws) < RULES.most_effects
        level = worth[best] if joins and best is not None else odds - SURE_ODDS
        extended = {
            _with(form, acting, law): gain - level
            for law, gain in worth.items()
            if gain > level - SURE_ODDS
        }
        if not joins:
            return _Look(model, acting, psi, {**rivals, **extended, acting: 0.0})
        rivals = extended
        acting = max(extended, key=lambda one_more: extended[one_more])
        at = climb(model, psi, acting)
        psi, model = at.psi, model.around(model.fitted_laws(at), shapes)


def _with(form: Quadratic, acting: Acting, law: Law) -> Acting:
    """Return effects that act together with one more, each at its best shape."""
    laws = (*acting.laws, law)
    return Acting(laws, form.choice(laws, [*acting.shapes, 0.0]).shapes)


def _known_by_data(precision: Array, law: Law, shape: float) -> float:
    """Return the precision with which data know an amplitude, over that of its prior."""
    weights, places = law.weights(np.asarray(shape)), list(law.places)
    return float(weights @ precision[np.ix_(places, places)] @ weights)


def _gain(form: Quadratic, laws: Sequence[Law], shapes: Sequence[float]) -> float:
    """Return what effects add to the log evidence, the last one's shape integrated over."""
    if not laws:
        return 0.0
    if laws[-1].has_shape:
        return form.along(laws, shapes, len(laws) - 1)[1]
    return float(form.values(laws, [np.array([shape]) for shape in shapes])[0])


def _odds_of_one_more(model: LinearModel, acting: int) -> float:
    """Return the log Bayes factor from which on a diagnosis is sure of one effect more [nat]."""
    prior, among = model.analysis.diagnosis.hypotheses, len(model.lawbook)

    def log_prior(count: int) -> float:
        mass = (prior.none, prior.one, prior.two, prior.more)[min(count, 3)]
        return log(mass) - log(comb(among, count))

    return SURE_ODDS + log_prior(acting) - log_prior(acting + 1)


def _spread_of_law(look: _Look) -> dict[str, float]:
    """Return the error of each number of the law where the law may be off, by name.

    It is that of a diagnosis: over all hypotheses that stay open, and over runs to come.
    """
    model, windows, rng = look.model, residuals_of(look.model, look.psi), np.random.default_rng(0)
    odds = np.exp(list(look.open_for.values()))
    counts = rng.multinomial(DRAWS, odds / odds.sum()).tolist()
    parts = []
    for acting, count in zip(look.open_for, counts, strict=True):
        at = model.evaluate(look.psi, acting)
        weighed = Weighed(acting.names, at.value, None, acting, at)
        parts.append(drawn_laws(model, weighed, windows, count, rng))
    drawn = np.concatenate(parts)
    at = model.evaluate(look.psi, look.acting)
    left = windows.left(spread_numbers(model, at.mean, model.mixing(look.acting)))
    scatter = scatter_of_runs(model, windows, left)
    deviation = np.zeros(DRAWS) if scatter is None else scatter.deviations(DRAWS, rng)
    return {
        name: float((drawn[:, place, column] * (1 + deviation * (name in FRICTION))).std())
        for place, size in enumerate(model.layout.sizes)
        for column, (name, _) in enumerate(model.data.law_numbers(size))
    }


def _effects(look: _Look) -> pd.DataFrame:
    """Return from which amplitude on each law of each effect is named, and below which not."""
    model = look.model
    precision = model.reduced(look.psi, Acting()).precision
    odds = _odds_of_one_more(model, 0)
    best = dict(zip(look.acting.laws, look.acting.shapes, strict=True))
    rows = {}
    for law in (law for laws in model.lawbook.values() for law in laws):
        at, amplitude = best.get(law, 0.0), model.analysed(law.effect).amplitude
        shapes = (at, -USUAL_SHAPES, USUAL_SHAPES) if law.has_shape else (at,)
        errors = [_errors(model, precision, law, shape) for shape in shapes]
        if not np.isfinite(errors[0][0]):
            continue
        named, unnamed = (
            [_named_from(*of_shape, amplitude.prior, odds, probability) for of_shape in errors]
            for probability in (FOUND_WITH, HIDDEN_WITH)
        )
        rows[f"{law.effect}/{law.law}"] = {
            "smallest": named[0],
            "unseen": min(unnamed),
            "unit": amplitude.unit,
            "share": _share(model, model.candidate(law, at), named[0]),
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


def _share(model: LinearModel, candidate: Candidate, amplitude: float) -> float | None:
    """Return the rms of an amplitude as a share of friction; None of what is no friction."""
    if candidate.effect.acts_on != "friction":
        return None
    sizes = [rig.rows.size_of(candidate) ** 2 for rig in model.rigs]
    return amplitude * float(np.sqrt(np.mean(sizes)))

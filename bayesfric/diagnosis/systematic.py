"""Posteriors of the effects and of the gap, averaged over hypotheses.

The gap is the rms of the systematic force over the recording's conditions, after recalibration of
the law. This force is the sum of effects, errors of their laws, small amounts and smooth forces.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bayesfric.arrays import Array
from bayesfric.diagnosis.acting import Acting, At
from bayesfric.diagnosis.at_shapes import numbers_at_shapes
from bayesfric.diagnosis.discrepancy import Wide
from bayesfric.diagnosis.effect_draws import DRAWS, EffectDraws, drawn_shapes
from bayesfric.diagnosis.hypotheses import Search
from bayesfric.diagnosis.left_open import drawn_numbers
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.refitted import RefittedLaw
from bayesfric.diagnosis.residuals import AT_ONCE, Residuals, spread_numbers
from bayesfric.diagnosis.weighing import Weighed
from bayesfric.diagnosis_rules import RULES
from bayesfric.effects.candidates import is_positive
from bayesfric.hypothesis import UNKNOWN, Hypothesis
from bayesfric.inference.truncated import drawn_above_zero
from bayesfric.observation.layout import COEFFICIENTS
from bayesfric.probabilities import total

SMALLEST = 1e-9  # least gap that can shrink, relative to friction
# Of friction: what windows and linearisation leave of boards without noise (docs/blind.md).


@dataclass(frozen=True)
class Posterior:
    """Draws over all hypotheses.

    Parameters
    ----------
    hypothesis : ndarray of Hypothesis, shape (S,)
        Hypothesis of each draw.
    force : ndarray, shape (R, S)
        Systematic force in each window after recalibration of the law [N].
    hidden2 : ndarray, shape (S,)
        Mean square of periodic forces with unrecorded phase [N²].
    unresolved2 : ndarray, shape (S,)
        Mean square of forces that are too fine for windows and smooth forces [N²]. It is not
        part of the gap, but limits how much of the gap the causes can be shown to explain.
    gap : ndarray, shape (S,)
        Rms of the systematic force, including periodic forces with unrecorded phase [N].
    strengths : dict of str to ndarray, shape (S,)
        By effect: rms force over rms friction, 0 in draws in which it does not act.
    left : dict of str to float
        By effect: mean rms, over rms friction, of the part of its force that a recalibrated law
        leaves.
    amplitudes, shapes : dict of str to ndarray
        By effect: values in the draws in which it acts.
    waves : dict of str to list of ndarray, shape (R,)
        By effect that is periodic along the path: its force at amplitude 1 with the best period,
        for each hypothesis [N].
    law : RefittedLaw
        Coefficients and amplitudes, drawn together.
    """

    hypothesis: NDArray[np.object_]
    force: Array
    hidden2: Array
    unresolved2: Array
    gap: Array
    strengths: dict[str, Array]
    left: dict[str, float]
    amplitudes: dict[str, Array]
    shapes: dict[str, Array]
    waves: dict[str, list[Array]]
    law: RefittedLaw


def posterior_of(
    model: LinearModel, search: Search, residuals: Residuals, rng: np.random.Generator
) -> Posterior:
    """Draw effects and systematic forces over all hypotheses.

    Parameters
    ----------
    model : LinearModel
        The model in which the hypotheses were compared.
    search : Search
        The hypotheses.
    residuals : Residuals
        Windows of that model.
    rng : Generator
        Source of randomness.
    """
    hypotheses: list[Hypothesis] = []
    force, hidden = np.empty((residuals.size.size, DRAWS)), []
    effects = EffectDraws(model, residuals)
    refitted = RefittedLaw(model.layout.sizes, DRAWS)
    for hypothesis, count in _draws_of_each(search, rng).items():
        rows = slice(len(hypotheses), len(hypotheses) + count)
        own, weighed, wide = _hypothesis_of(model, search, hypothesis)
        drawn = _numbers(own, weighed, wide, count, rng)
        forms = weighed.forms if wide is None or search.unknown is None else search.unknown.forms
        numbers = drawn
        at: Sequence[Array | float] = weighed.acting.shapes
        if model.data.rigs[0].along_path:
            numbers, shapes = numbers_at_shapes(own, weighed, wide, forms, drawn, rng)
            at = shapes
        else:
            shapes = drawn_shapes(own, weighed, count, rng)
        moves = []
        for start in range(0, count, AT_ONCE):  # forces of all draws are large
            some = drawn[start : start + AT_ONCE]
            made, moved = _force_and_law(model, residuals, own, weighed.acting, some)
            place = rows.start + start
            force[:, place : place + len(some)] = residuals.without_law(made)
            moves.append(moved)
        of_law = np.concatenate(moves) + _of_the_law(own, numbers - drawn)
        refitted.take(rows, own, weighed.acting, weighed.at.psi, numbers, of_law, at)
        effects.take_columns(rows, own, weighed, drawn, numbers, shapes)
        hidden.append(effects.take_phases(rows, own, weighed, wide, forms, rng))
        hypotheses += [hypothesis] * count
    hidden2 = np.concatenate(hidden)
    rms = residuals.friction_rms
    return Posterior(
        np.array(hypotheses, dtype=object),
        force,
        hidden2,
        (RULES.unresolved * rms * rng.standard_normal(DRAWS)) ** 2,
        np.sqrt(residuals.mean_square(force) + hidden2),
        effects.strengths,
        {name: float(np.mean(values)) for name, values in effects.left.items()},
        {name: np.concatenate(values) for name, values in effects.amplitudes.items()},
        {name: np.concatenate(values) for name, values in effects.shapes.items()},
        effects.waves,
        refitted,
    )


def _draws_of_each(search: Search, rng: np.random.Generator) -> dict[Hypothesis, int]:
    """Return the number of draws of each hypothesis that has any."""
    chances = {
        hypothesis: chance
        for hypothesis, chance in search.probabilities().items()
        if chance > RULES.rare
        and (hypothesis in search.weighed or (hypothesis == UNKNOWN and search.unknown is not None))
    }
    weights = np.array(list(chances.values()))
    counts = rng.multinomial(DRAWS, weights / weights.sum())
    return {
        hypothesis: count
        for hypothesis, count in zip(chances, counts.tolist(), strict=True)
        if count
    }


def _hypothesis_of(
    model: LinearModel, search: Search, hypothesis: Hypothesis
) -> tuple[LinearModel, Weighed, Wide | None]:
    """Return the model for a hypothesis, its posterior, and its unknown force if it has one.

    The hypothesis of an unknown force contains the effects that act with it.
    """
    if hypothesis != UNKNOWN or search.unknown is None:
        return model, search.weighed[hypothesis], None
    force = search.unknown
    return model.full, replace(search.none, acting=force.acting, at=force.at), force.best


def _numbers(
    model: LinearModel, weighed: Weighed, wide: Wide | None, count: int, rng: np.random.Generator
) -> Array:
    """Draw a hypothesis' numbers, (S, p)."""
    if wide is None:
        drawn = drawn_numbers(model, weighed, count, rng)
    else:
        drawn = rng.multivariate_normal(
            weighed.at.mean, weighed.at.covariance, count, check_valid="ignore", method="eigh"
        )
    return _made_positive(model, weighed.acting, weighed.at, drawn, rng)


def _force_and_law(
    model: LinearModel, residuals: Residuals, own: LinearModel, acting: Acting, drawn: Array
) -> tuple[Array, Array]:
    """Draw the systematic force in each window, (R, S), and changes of the law's coefficients."""
    full = model.full.layout
    local = spread_numbers(own, drawn, own.mixing(acting))
    moves = local[:, :, :3].copy()
    local[:, :, :3] = 0.0
    local[:, :, local.shape[2] - sum(model.layout.nuisances) :] = 0.0
    force = _made(residuals, local)
    # A smooth force may contain a part of the law; the recalibrated law includes it.
    local[:, :, full.own : full.own + full.candidates] = 0.0
    if model.data.rigs[0].along_path:
        local[:, :, _of_acting(model, acting)] = 0.0
    return force, moves + residuals.taken_by_law(_made(residuals, local))


def _of_the_law(model: LinearModel, numbers: Array) -> Array:
    """Return the coefficients of each size, (S, sizes, 3), from all numbers, (S, p)."""
    layout, sizes = model.layout, len(model.layout.sizes)
    local = numbers[:, : layout.own * sizes].reshape(len(numbers), sizes, layout.own)
    return np.asarray(local[:, :, :COEFFICIENTS])


def _of_acting(model: LinearModel, acting: Acting) -> list[int]:
    """Return local columns of small amounts and forms that belong to acting effects.

    They are not part of the law. Those of other effects of the same ladder are included.
    """
    effects = [model.candidates[law.places[0]].effect for law in acting.laws]
    names = {effect.name for effect in effects} | {law.effect for law in acting.laws}
    ladders = {effect.ladder for effect in effects if effect.ladder}
    traces = [candidate.effect for candidate, _ in model.full.discrepancy.amounts]
    traces += [form.candidate.effect for form in model.forms]
    layout = model.full.layout
    first = layout.own + layout.candidates + layout.shared - len(traces)
    return [
        first + place
        for place, effect in enumerate(traces)
        if effect.name in names or effect.ladder in ladders
    ]


def _made(residuals: Residuals, local: Array) -> Array:
    """Return the force of local numbers, (S, sizes, q), in each window, (R, S) [N]."""
    force = np.empty((residuals.size.size, len(local)))
    for size in range(local.shape[1]):
        mine = residuals.size == size
        force[mine] = residuals.columns[mine] @ local[:, size].T
    return force


def _made_positive(
    model: LinearModel, acting: Acting, at: At, drawn: Array, rng: np.random.Generator
) -> Array:
    """Draw positive amplitudes again that are below 0; return all numbers, (S, p)."""
    for place, law in zip(model.places(len(acting.laws)), acting.laws, strict=True):
        if not is_positive(model.amplitude_prior(law)):
            continue
        below = drawn[:, place] <= 0
        if below.any():
            mean, variance = at.mean[place], at.covariance[place, place]
            again = drawn_above_zero(mean, np.sqrt(variance), int(below.sum()), rng)
            # Correlated numbers move with it.
            moved = again - drawn[below, place]
            drawn[below] += moved[:, None] * at.covariance[place] / variance
    return drawn


def left_of(residuals: Residuals, posterior: Posterior, taken: Array) -> Array:
    """Return draws of the squared gap minus a predicted force, shape (S,) [N²].

    Parameters
    ----------
    residuals : Residuals
        Contains the weights.
    posterior : Posterior
        Draws of the gap.
    taken : ndarray, shape (R,) or (R, S)
        Predicted force after recalibration of the law [N].
    """
    taken = taken.reshape(len(taken), -1)
    return np.asarray(residuals.mean_square(posterior.force, taken) + posterior.hidden2)


def shrink_of(residuals: Residuals, posterior: Posterior, columns: Array) -> Array | None:
    """Return draws of the part of the squared gap that causes explain; None without a gap.

    In each draw the amplitudes are those that explain most. What remains is the part that their
    laws cannot describe, periodic forces with unrecorded phase, and unresolved forces. Errors of
    amplitudes are not included; they show in held-out data.

    Parameters
    ----------
    residuals : Residuals
        Contains the weights.
    posterior : Posterior
        Draws of the gap.
    columns : ndarray, shape (R, k)
        Force of each cause at amplitude 1, after recalibration of the law [N].
    """
    taken = best_of(residuals, columns, posterior.force)
    there = posterior.gap > SMALLEST * residuals.friction_rms
    whole = posterior.gap**2 + posterior.unresolved2
    left = left_of(residuals, posterior, taken) + posterior.unresolved2
    return np.asarray(1 - left[there] / whole[there]) if there.any() else None


def best_of(residuals: Residuals, columns: Array, force: Array) -> Array:
    """Return the weighted least-squares fit of columns, (R, k), to forces, (R, …) [N]."""
    root = np.sqrt(residuals.weight)
    target = (force.T * root).T
    return np.asarray(columns @ np.linalg.lstsq(root[:, None] * columns, target, rcond=None)[0])


def inclusion(search: Search) -> dict[str, float]:
    """Return the posterior probability that each effect acts."""
    within: dict[str, list[float]] = {}
    for hypothesis, chance in search.probabilities().items():
        for effect in () if hypothesis == UNKNOWN else hypothesis:
            within.setdefault(effect, []).append(chance)
    return {name: total(parts) for name, parts in within.items()}

"""Effects as they are reported: size, probability, and whether the size is plausible."""

import re
from collections.abc import Callable, Sequence

import numpy as np
from scipy.special import ndtri

from bayesfric.arrays import Array
from bayesfric.diagnosis.acting import Law
from bayesfric.diagnosis.checked import Checked, factor_error
from bayesfric.diagnosis.hypotheses import Search
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.systematic import Posterior, inclusion
from bayesfric.diagnosis.unknown import Unknown
from bayesfric.diagnosis.verdict import KnownEffect, measures
from bayesfric.diagnosis.weighing import Weighed
from bayesfric.effects import Effect, EffectParameter
from bayesfric.inference.priors import describe
from bayesfric.probabilities import LN10
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import Cause, EffectNumber, Inclusion

FORCES = re.compile("^(N|kg)")
"""Begins the unit of an amplitude that is in the scale of forces."""


def reported_effects(
    model: LinearModel, search: Search, posterior: Posterior, practical: float
) -> list[KnownEffect]:
    """Return probability and strength of each evaluated effect, the most probable first.

    Parameters
    ----------
    model : LinearModel
        The model in which the hypotheses were compared.
    search : Search
        The hypotheses.
    posterior : Posterior
        Draws.
    practical : float
        Practical share of friction.
    """
    chances = inclusion(search)
    effects_known = []
    for members in search.classes.members:
        name = members[0]
        strength = posterior.strengths.get(name)
        acts = None if strength is None else strength[strength > 0]
        above = 0.0 if acts is None or not acts.size else float(np.mean(acts >= practical))
        middle = 0.0 if acts is None or not acts.size else float(np.median(acts))
        effect = model.analysed(name)
        effects_known.append(
            KnownEffect(
                name,
                chances.get(name, 0.0),
                above,
                middle,
                measures(effect),
            )
        )
    return sorted(
        effects_known, key=lambda known_effect: (-known_effect.probability, known_effect.effect)
    )


def inclusion_of(
    effects_known: Sequence[KnownEffect], posterior: Posterior, practical: float
) -> tuple[Inclusion, ...]:
    """Return probability and strength of each effect in the form that is stored."""
    rows = []
    for effect in effects_known:
        strength = posterior.strengths.get(effect.effect)
        acts = None if strength is None else strength[strength > 0]
        drawn = acts is not None and acts.size > 0
        rows.append(
            Inclusion(
                effect=effect.effect,
                probability=effect.probability,
                strength=Interval.of_draws(acts) if drawn and acts is not None else None,
                strength_why=None if drawn else "it is too improbable to be drawn",
                probability_above_practical=effect.probability * effect.above_practical,
                makes_a_gap=posterior.left.get(effect.effect, 0.0) >= practical,
            )
        )
    return tuple(rows)


def implausible(
    names: Sequence[str], model: LinearModel, search: Search, posterior: Posterior
) -> list[str]:
    """Return the effects whose amplitude, or whose period, is outside the plausible range.

    Parameters
    ----------
    names : sequence of str
        Effects of any evaluated hypothesis.
        model, search, posterior
        As of :func:`reported_effects`.
    """
    beyond = []
    for name in names:
        if name not in posterior.amplitudes:
            continue
        effect, shape = _effect_of(name, model, search), posterior.shapes.get(name, np.empty(0))
        if not _is_plausible(effect, posterior.amplitudes[name]) or _is_no_period(effect, shape):
            beyond.append(name)
    return beyond


def _best_with(name: str, search: Search) -> Weighed | None:
    within = [weighed for weighed in search.weighed.values() if name in weighed.names]
    return max(within, key=search.worth) if within else None


def _law_of(name: str, best: Weighed) -> Law:
    return next(law for law in (*best.acting.laws, *best.acting.phases) if law.effect == name)


def _effect_of(name: str, model: LinearModel, search: Search) -> Effect:
    """Return the effect whose law stands for `name` in the best hypothesis (maybe a twin's)."""
    best = _best_with(name, search)
    if best is None:
        return model.analysed(name)
    return model.candidates[_law_of(name, best).places[0]].effect


def _is_no_period(effect: Effect, shape: Array) -> bool:
    """Return whether a wave's period is longer than the plausible part of the travel.

    Together with a spring, such a wave can describe any curve along the path.
    """
    if effect.shape is None or "period" not in effect.needs or not shape.size:
        return False
    return bool(np.median(shape) > effect.shape.plausible[1])


def _is_plausible(effect: Effect, amplitude: Array) -> bool:
    low, high = effect.amplitude.plausible
    return bool(low <= float(np.median(amplitude)) <= high)


def causes_of(
    names: Sequence[str],
    model: LinearModel,
    search: Search,
    posterior: Posterior,
    practical: float,
    floor: float,
    check: Callable[[Weighed | Unknown], Checked],
) -> tuple[Cause, ...]:
    """Return the stored entries of effects.

    Parameters
    ----------
    names : sequence of str
        Effects that some weighed hypothesis has.
    model, search, posterior, practical
        As of :func:`reported_effects`.
    floor : float
        Rms of scatter, relative to rms friction.
    check : callable
        Function of a hypothesis that returns the check of its evidence by importance draws.
    """
    chances = inclusion(search)
    causes = []
    for name in names:
        best = _best_with(name, search)
        if best is None or name not in posterior.amplitudes:
            continue
        law = _law_of(name, best)
        effect = model.candidates[law.places[0]].effect
        amplitude = posterior.amplitudes[name]
        if FORCES.search(effect.amplitude.unit):
            share = max(rig.scale_share for rig in model.data.rigs)
            amplitude = amplitude * (1 + share * _standard(amplitude.size))
        strengths = posterior.strengths[name]
        strength = float(np.median(strengths[strengths > 0])) if (strengths > 0).any() else 0.0
        rival = _best_without(name, search)
        error, error_why = factor_error(check(best), check(rival))
        causes.append(
            Cause(
                effect=name,
                sentence=model.analysed(name).sentence,
                inclusion_probability=chances.get(name, 0.0),
                log10_bayes_factor=(best.log_evidence - rival.log_evidence) / LN10,
                log10_bayes_factor_se=None if error is None else error / LN10,
                log10_bayes_factor_se_why=error_why,
                law=law.law,
                parameters=_parameters(name, effect, amplitude, posterior.shapes.get(name)),
                plausible=_is_plausible(effect, amplitude),
                plausible_range=effect.amplitude.plausible,
                plausible_reference=effect.amplitude.reference,
                strength=strength,
                makes_a_gap=posterior.left.get(name, 0.0) >= practical,
                below_floor=strength < floor,
            )
        )
    return tuple(causes)


def _parameters(
    name: str, effect: Effect, amplitude: Array, shape: Array | None
) -> dict[str, EffectNumber]:
    """Return the parameters of a cause, summarised from draws."""
    # The law may be that of a twin that this rig cannot distinguish; so are the parameters.
    whose = "" if effect.name == name else f"{effect.name}."
    parameters = {whose + effect.amplitude.name: _number(effect.amplitude, amplitude)}
    if effect.shape is not None and shape is not None and shape.size:
        parameters[whose + effect.shape.name] = _number(effect.shape, shape)
    return parameters


def _best_without(name: str, search: Search) -> Weighed | Unknown:
    """Return the hypothesis with the largest evidence among those without an effect."""
    rivals: list[Weighed | Unknown] = [
        weighed for weighed in search.weighed.values() if name not in weighed.names
    ]
    if search.unknown is not None:
        rivals.append(search.unknown)
    return max(rivals, key=lambda weighed: weighed.log_evidence)


def _standard(count: int) -> Array:
    """Return quantiles of a standard normal in a fixed random order, (count,)."""
    if count == 0:
        return np.zeros(0)
    spread = ndtri((np.arange(count) + 0.5) / count)
    return np.asarray(np.random.default_rng(0).permutation(spread))


def _number(parameter: EffectParameter, draws: Array) -> EffectNumber:
    five = Interval.of_draws(draws)
    return EffectNumber(
        **five.model_dump(),
        unit=parameter.unit,
        prior=describe(parameter.prior),
        prior_density=parameter.prior,
    )

"""The named causes: how large each is, how certain, and whether it is plausible."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import truncnorm

from bayesfric.diagnosis.linear_model import Acting, LinearModel
from bayesfric.diagnosis.shrink import interval
from bayesfric.diagnosis.weighing import Weighed
from bayesfric.diagnosis.which import NONE, Which, label
from bayesfric.effects import EffectParameter, State
from bayesfric.effects.candidates import Candidate, is_positive, unit_values
from bayesfric.inference.priors import describe, from_normal
from bayesfric.physics.friction import Coefficients
from bayesfric.schemas import Cause, EffectNumber

__all__ = ["CauseDraws", "cause_draws", "causes_of"]

Array = NDArray[np.float64]
DRAWS = 2000
REFERENCE_TENSION_N = 15.0
LN10 = float(np.log(10))


@dataclass(frozen=True)
class CauseDraws:
    """Draws of the parameters of one cause.

    Parameters
    ----------
    amplitude : ndarray, shape (S,)
        In the unit of the parameter.
    shape : ndarray, shape (S,), or None
        Likewise.
    """

    amplitude: Array
    shape: Array | None


def cause_draws(
    model: LinearModel, found: Weighed, rng: np.random.Generator
) -> dict[str, CauseDraws]:
    """Draw the parameters of effects that act together.

    Parameters
    ----------
    model : LinearModel
        Around the law that was fitted with them.
    found : Weighed
        Their laws and shapes, weighed.
    rng : Generator
        Source of randomness.
    """
    counts = rng.multinomial(DRAWS, np.exp(found.log_weights) / np.exp(found.log_weights).sum())
    amplitude = {name: np.empty(0) for name in found.names}
    shape = {name: np.empty(0) for name in found.names}
    for choice, count in zip(found.choices, counts, strict=True):
        if not count:
            continue
        drawn = _amplitudes(model, found.psi, choice, int(count), rng)
        for place in (*choice.columns, *choice.phases):
            candidate = model.candidates[place]
            name, prior = candidate.effect.name, candidate.effect.amplitude.prior
            # Within the node's own part of the prior, any value will do.
            near = candidate.node + candidate.cell * rng.uniform(-0.5, 0.5, count)
            if place in choice.phases:
                values, shapes = from_normal(prior, near), np.empty(0)
            else:
                values = drawn[place]
                own = candidate.effect.shape
                shapes = np.empty(0) if own is None else from_normal(own.prior, near)
            amplitude[name] = np.append(amplitude[name], values)
            shape[name] = np.append(shape[name], shapes)
    return {
        name: CauseDraws(amplitude[name], shape[name] if shape[name].size else None)
        for name in found.names
    }


def _amplitudes(
    model: LinearModel, psi: Array, choice: Acting, count: int, rng: np.random.Generator
) -> dict[int, Array]:
    """Draw the amplitudes of candidates with columns, none of a half-normal below 0."""
    if not choice.columns:
        return {}
    mean, sd = model.prior(choice.columns)
    centre, covariance = model.information(psi, choice).posterior(mean, sd)
    places = model.places(choice.columns)
    own = model.layout.own * np.arange(len(model.layout.sizes))
    both = np.concatenate([places, own, own + 1])  # with c1 and c2 of each size
    drawn = rng.multivariate_normal(
        centre[both], covariance[np.ix_(both, both)], count, method="eigh"
    )
    grown = _friction_growth(model, drawn[:, places.size :].T.reshape(2, -1, count))
    found = {}
    for row, place in enumerate(choice.columns):
        values, candidate = drawn[:, row], model.candidates[place]
        if is_positive(candidate.effect.amplitude.prior):
            # What lies below 0 is drawn again, one at a time, above it.
            at, width = centre[places[row]], np.sqrt(covariance[places[row], places[row]])
            again = truncnorm.ppf(rng.uniform(size=count), -at / width, np.inf, at, width)
            values = np.where(values > 0, values, again)
        # The force is known, and a share of friction no better than friction.
        values = values / grown ** _degree(candidate)
        found[place] = values * model.scale(model.layout.candidate(place))
    return found


def _friction_growth(model: LinearModel, numbers: Array) -> Array:
    """Return a pulley's friction over that of the reference law, sizes averaged, shape (S,).

    Sizes count by the square of their friction, as an effect in proportion to it does.
    """
    total, weights = np.zeros(numbers.shape[-1]), 0.0
    for row, size in enumerate(model.layout.sizes):
        law = model.laws[size]
        friction = float(np.asarray(law.c1)) * REFERENCE_TENSION_N + float(np.asarray(law.c2))
        added = numbers[0, row] * model.scale(0) * REFERENCE_TENSION_N
        added = added + numbers[1, row] * model.scale(1)
        weight = model.friction_scale[size] ** 2
        total += weight * (1 + added / friction)
        weights += weight
    return np.asarray(total / weights)


def _degree(candidate: Candidate) -> float:
    """Return by which power of friction an effect's force grows: 1 of a share of it, else 0."""
    if candidate.effect.acts_on != "friction":
        return 0.0
    values, _ = unit_values(candidate)
    # Along a trial of 0.6 m, wherever the effect is largest.
    along = np.linspace(0.0, 1.0, 25)
    force = []
    for grown in (1.0, 1.01):
        law = Coefficients(0.01 * grown, 0.02 * grown, 2e-5 * grown)
        state = State.of(
            law,
            9.0,
            60.0,
            20.0,
            1.1 * along,
            travel_m=0.6 * along,
            acceleration_m_s2=1.0,
            order=along,
        )
        force.append(float(np.abs(candidate.effect.laws[candidate.law](values, state)).max()))
    return float(np.log(force[1] / force[0]) / np.log(1.01)) if force[0] > 0 else 0.0


def causes_of(
    model: LinearModel,
    found: Weighed,
    which: Which,
    draws: dict[str, CauseDraws],
    strength: dict[str, float],
    floor: float,
) -> tuple[Cause, ...]:
    """Return what is to be said of each cause.

    Parameters
    ----------
    model : LinearModel
        Around the law that was fitted with them.
    found : Weighed
        Their laws and shapes, weighed.
    which : Which
        All hypotheses.
    draws : dict of str to CauseDraws
        By effect.
    strength : dict of str to float
        Rms of each effect's force over rms friction.
    floor : float
        Rms of scatter over rms friction.
    """
    chances = which.probabilities()
    causes = []
    for name in found.names:
        rest = label(tuple(n for n in found.names if n != name))
        gain = which.log_evidence[label(found.names)] - which.log_evidence.get(
            rest, which.log_evidence[NONE]
        )
        effect = next(c.effect for c in model.candidates if c.effect.name == name)
        own = draws[name]
        middle = float(np.median(own.amplitude))
        low, high = effect.amplitude.plausible
        parameters = {effect.amplitude.name: _number(effect.amplitude, own.amplitude)}
        if effect.shape is not None and own.shape is not None:
            parameters[effect.shape.name] = _number(effect.shape, own.shape)
        best = next(
            model.candidates[place]
            for place in (*found.best.columns, *found.best.phases)
            if model.candidates[place].effect.name == name
        )
        causes.append(
            Cause(
                effect=name,
                sentence=effect.sentence,
                inclusion_probability=min(
                    1.0, sum(p for h, p in chances.items() if name in h.split("+"))
                ),
                log10_bayes_factor=gain / LN10,
                log10_bayes_factor_se=which.error / LN10,
                law=best.law,
                parameters=parameters,
                plausible=low <= middle <= high,
                plausible_range=(low, high),
                plausible_reference=effect.amplitude.reference,
                strength=strength[name],
                below_floor=strength[name] < floor,
            )
        )
    return tuple(causes)


def _number(parameter: EffectParameter, draws: Array) -> EffectNumber:
    five = interval(draws)
    return EffectNumber(
        **five.model_dump(),
        unit=parameter.unit,
        prior=describe(parameter.prior),
        prior_density=parameter.prior,
    )

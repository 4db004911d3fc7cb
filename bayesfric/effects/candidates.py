"""Effects as candidates: each law, at each node of its shape, is one column of the linear model.

A shape parameter, such as the Stribeck speed, has nodes over its prior. Columns are interpolated
between the nodes. An effect whose phases are not recorded has no column: its amplitude is the
standard deviation of a scatter of every trial.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.special import ndtri

from bayesfric.analysis import HalfCauchy, HalfNormal, LogNormal, Normal, Prior, Uniform
from bayesfric.arrays import Array
from bayesfric.effects import Effect
from bayesfric.inference.priors import from_normal

SHAPE_NODES = np.linspace(-2.4, 2.4, 13)
"""Nodes of a shape, as normal quantiles of its prior."""
LINEAR_STEP = 1e-4  # share of the prior's sd at which laws are linearised in their amplitude


@dataclass(frozen=True)
class Candidate:
    """An effect with one of its laws and one shape.

    Parameters
    ----------
    effect : Effect
        The effect.
    law : str
        Name of the variant.
    node : float
        Normal quantile of the shape; 0 without one.
    """

    effect: Effect
    law: str
    node: float

    @property
    def shape(self) -> float | None:
        """The value of the shape parameter; None without one."""
        if self.effect.shape is None:
            return None
        return float(from_normal(self.effect.shape.prior, self.node))


def candidates_of(effect: Effect) -> list[Candidate]:
    """Return the candidates of an effect, by law and then by ascending nodes of the shape."""
    nodes = np.zeros(1) if effect.shape is None else SHAPE_NODES
    return [Candidate(effect, law, float(node)) for law in effect.laws for node in nodes]


def unit_values(candidate: Candidate) -> tuple[Mapping[str, Any], float]:
    """Return parameters at a small amplitude, and that amplitude, the divisor of the response."""
    effect = candidate.effect
    small = LINEAR_STEP * prior_moments(effect.amplitude.prior)[1]
    values: dict[str, Any] = {effect.amplitude.name: np.float64(small)}
    if effect.shape is not None:
        values[effect.shape.name] = np.float64(candidate.shape)
    return values, small


def unit_response(candidate: Candidate, where: Any) -> Array:
    """Return the response at amplitude 1, extrapolated linearly from a small amplitude."""
    values, small = unit_values(candidate)
    return np.asarray(candidate.effect.laws[candidate.law](values, where)) / small


def prior_moments(prior: Prior) -> tuple[float, float]:
    """Return mean and standard deviation of the normal that replaces a prior.

    A half-normal prior is replaced by the normal whose absolute value it is; see
    :func:`is_positive`. A half-Cauchy prior is first replaced by the half-normal with its median.
    Student-t, gamma, beta and truncated priors are replaced by the normal with their median and
    half the width of their 68 % interval.
    """
    match prior:
        case HalfNormal(scale=scale):
            return 0.0, scale
        case Normal(mean=mean, sd=sd):
            return mean, sd
        case LogNormal(median=median, sd_log=sd):
            return median * float(np.exp(sd**2 / 2)), median * sd
        case Uniform(low=low, high=high):
            return (low + high) / 2, (high - low) / float(np.sqrt(12))
        case HalfCauchy(scale=scale):
            return 0.0, scale / float(ndtri(0.75))
        case _:
            low, middle, high = from_normal(prior, [-1.0, 0.0, 1.0])
            return float(middle), float(high - low) / 2


def is_positive(prior: Prior) -> bool:
    """Return whether a prior is a half-normal, or is replaced by one."""
    return isinstance(prior, HalfNormal | HalfCauchy)


def has_no_equivalent_force(effect: Effect) -> bool:
    """Return whether an effect on readings has no equivalent force."""
    return effect.acts_on == "reading" and bool(effect.components or effect.shape)


def on_friction(acting: Sequence[tuple[Candidate, float]]) -> list[tuple[Candidate, float]]:
    """Return those effects, with their amplitudes, that are a known force of friction."""
    return [
        (candidate, amplitude)
        for candidate, amplitude in acting
        if candidate.effect.acts_on == "friction" and not candidate.effect.components
    ]

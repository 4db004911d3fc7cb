"""Active effects, each with one of its laws, as parameters of a likelihood."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from bayesfric.arrays import Array
from bayesfric.effects import Effect, State
from bayesfric.inference.priors import Parameter, from_normal, prior_width, to_normal

SHAPE_RANGE = 3.0  # range of the table of a shape parameter, in prior standard deviations
SHAPE_NODES = 33
START_SHARE = 0.1  # share of the prior's sd: the amplitude at which an optimisation starts
REDUCED_TO = 1e-3  # of the leading singular value: smaller ones are dropped


@dataclass(frozen=True)
class ActiveEffect:
    """An effect with one of its laws.

    Parameters
    ----------
    effect : Effect
        The effect.
    law : str
        Name of the variant.
    """

    effect: Effect
    law: str

    @property
    def label(self) -> str:
        """Name of the effect and of its law, as in ``viscous/tension``."""
        return f"{self.effect.name}/{self.law}"

    def values(self, theta: Mapping[str, Array]) -> dict[str, Array]:
        """Return the effect's parameters by their own names, each of shape (W, 1)."""
        return {
            parameter.name: theta[f"{self.effect.name}.{parameter.name}"][:, None]
            for parameter in self.effect.parameters
        }


def parameters_of(active: ActiveEffect) -> tuple[Parameter, ...]:
    """Return the parameters of an effect, named ``effect.parameter``."""
    return tuple(
        Parameter(f"{active.effect.name}.{parameter.name}", parameter.unit, parameter.prior)
        for parameter in active.effect.parameters
    )


def small_values(effect: Effect) -> dict[str, Any]:
    """Return a small amplitude and the median shape by their own names."""
    amplitude, shape = effect.amplitude, effect.shape
    values: dict[str, Any] = {
        amplitude.name: np.float64(START_SHARE * prior_width(amplitude.prior))
    }
    if shape is not None:
        values[shape.name] = np.float64(from_normal(shape.prior, 0.0))
    return values


def rough_values(active: Sequence[ActiveEffect]) -> dict[str, float]:
    """Return small amplitudes and median shapes, at which an optimisation starts."""
    return {
        f"{acting.effect.name}.{name}": float(value)
        for acting in active
        for name, value in small_values(acting.effect).items()
    }


def total(active: Sequence[ActiveEffect], theta: Mapping[str, Array], state: State) -> Array:
    """Return the sum of effects that act on the same quantity, in the shape of the state."""
    return np.asarray(
        sum(acting.effect.laws[acting.law](acting.values(theta), state) for acting in active)
    )


@dataclass(frozen=True)
class LinearTerm:
    """An effect along a path as a sum of K fixed responses, each times a number.

    The number is the amplitude times a function of the shape parameter. The functions
    and the responses are the leading singular vectors of the effect's response over a
    table of shapes.

    Parameters
    ----------
    active : ActiveEffect
        The effect.
    responses : ndarray, shape (K, …)
        Responses at unit amplitude.
    spline : scipy.interpolate.BSpline or None
        From the normal quantile of the shape to K numbers; None without a shape.
    """

    active: ActiveEffect
    responses: Array
    spline: "scipy.interpolate.BSpline | None"

    def amplitudes(self, theta: Mapping[str, Array]) -> Array:
        """Return the number of each response, shape (K, W)."""
        effect = self.active.effect
        amplitude = theta[f"{effect.name}.{effect.amplitude.name}"]
        if self.spline is None or effect.shape is None:
            return amplitude[None]
        shape = theta[f"{effect.name}.{effect.shape.name}"]
        place = np.clip(to_normal(effect.shape.prior, shape), -SHAPE_RANGE, SHAPE_RANGE)
        return np.asarray(amplitude * self.spline(place).T)


def linear_terms(
    active: Sequence[ActiveEffect],
    response: Callable[[ActiveEffect, Mapping[str, Any]], Array],
    seen: Callable[[Array], Array],
) -> list[LinearTerm]:
    """Reduce effects to fixed responses.

    Parameters
    ----------
    active : sequence of ActiveEffect
        Effects that are linear in their amplitude.
    response : callable
        (effect, values of its parameters) to its response, an array of any one shape.
    seen : callable
        (response) to its observable part, by which responses are compared.

    Returns
    -------
    list of LinearTerm
        One for each effect.
    """
    terms = []
    for acting in active:
        effect = acting.effect
        unit = {effect.amplitude.name: np.float64(1.0)}
        if effect.shape is None:
            terms.append(LinearTerm(acting, response(acting, unit)[None], None))
            continue
        place = np.linspace(-SHAPE_RANGE, SHAPE_RANGE, SHAPE_NODES)
        shapes = from_normal(effect.shape.prior, place)
        table = np.stack([response(acting, unit | {effect.shape.name: shape}) for shape in shapes])
        flat = np.stack([seen(row).ravel() for row in table])
        left, singular, _ = np.linalg.svd(flat, full_matrices=False)
        kept = singular > REDUCED_TO * singular[0]
        spline = scipy.interpolate.make_interp_spline(place, left[:, kept] * singular[kept], k=5)
        responses = np.tensordot(left[:, kept].T / singular[kept, None], table, axes=1)
        terms.append(LinearTerm(acting, responses, spline))
    return terms

"""The effects, laws and shapes of a hypothesis, and its posterior at given noise parameters."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy

from bayesfric.arrays import Array
from bayesfric.effects.candidates import Candidate
from bayesfric.inference.information import Information


@dataclass(frozen=True)
class Law:
    """One law of an effect, with a candidate at each node of its shape parameter.

    Parameters
    ----------
    effect, law : str
        Their names.
    places : tuple of int
        Positions of its candidates in the model's list, by ascending shape.
    nodes : tuple of float
        Shapes of these candidates, as normal quantiles of the prior.
    log_weight : float
        Log prior weight of this law among the laws of the effect.
    """

    effect: str
    law: str
    places: tuple[int, ...]
    nodes: tuple[float, ...]
    log_weight: float

    @property
    def has_shape(self) -> bool:
        """Whether the law has a shape parameter."""
        return len(self.nodes) > 1

    @cached_property
    def _spline(self) -> "scipy.interpolate.BSpline":
        return scipy.interpolate.make_interp_spline(self.nodes, np.eye(len(self.nodes)), k=5)

    def weights(self, shape: Array) -> Array:
        """Return the interpolation weights of the candidates at given shapes, (…, nodes)."""
        if not self.has_shape:
            return np.ones((*np.shape(shape), 1))
        return np.asarray(self._spline(np.clip(shape, self.nodes[0], self.nodes[-1])))


@dataclass(frozen=True)
class Acting:
    """Effects that act together, each with a law and a shape.

    Parameters
    ----------
    laws : tuple of Law
        Laws of effects with columns in the linear model.
    shapes : tuple of float
        Shape of each of these laws, as a normal quantile.
    phases : tuple of Law
        Laws of periodic effects with unrecorded phases.
    """

    laws: tuple[Law, ...] = ()
    shapes: tuple[float, ...] = ()
    phases: tuple[Law, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects, sorted."""
        return tuple(sorted(law.effect for law in (*self.laws, *self.phases)))


@dataclass(frozen=True)
class At:
    """Posterior of a hypothesis at given noise parameters.

    Parameters
    ----------
    psi : ndarray
        Logarithms of the noise parameters.
    value : float
        Log joint density of data and noise parameters; the numbers are integrated out.
    gradient : ndarray or None
        Its gradient with respect to `psi`.
    information : Information
        Information of the data on the numbers.
    mean, covariance : ndarray
        Posterior moments of the numbers.
    at_mode : bool
        Whether `psi` is a mode.
    """

    psi: Array
    value: float
    gradient: Array | None
    information: Information
    mean: Array
    covariance: Array
    at_mode: bool = False


def phase_name(law: Law) -> str:
    """Return the name of a periodic effect's amplitude among the noise parameters."""
    return f"{law.effect}:{law.law}"


def lawbook(candidates: Sequence[Candidate]) -> dict[str, tuple[Law, ...]]:
    """Return the laws of each effect."""
    by_effect: dict[str, dict[str, list[int]]] = {}
    for place, candidate in enumerate(candidates):
        by_effect.setdefault(candidate.effect.name, {}).setdefault(candidate.law, []).append(place)
    return {
        name: tuple(
            Law(
                name,
                law,
                tuple(places),
                tuple(candidates[place].node for place in places),
                -float(np.log(len(laws) * candidates[places[0]].effect.searched)),
            )
            for law, places in laws.items()
        )
        for name, laws in by_effect.items()
    }


def merged(
    laws_of: Mapping[str, tuple[Law, ...]], members: Sequence[Sequence[str]]
) -> dict[str, tuple[Law, ...]]:
    """Return a lawbook in which the first effect of each class has the laws of the whole class.

    Parameters
    ----------
    laws_of : mapping of str to tuple of Law
        As :func:`lawbook` returns it.
    members : sequence of sequence of str
        Classes of effects that the data cannot distinguish.
    """
    merged_laws = dict(laws_of)
    for first, *others in members:
        laws = [law for name in (first, *others) for law in merged_laws[name]]
        share = np.log(1 + len(others))
        if others:
            merged_laws[first] = tuple(
                replace(
                    law,
                    effect=first,
                    law=law.law if law.effect == first else f"{law.law} ({law.effect})",
                    log_weight=law.log_weight - share,
                )
                for law in laws
            )
    return merged_laws

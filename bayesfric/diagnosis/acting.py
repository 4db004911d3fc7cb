"""Which effects act in a hypothesis, by which laws and shapes, and the hypothesis at one noise."""

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
    """One law of an effect: its candidates and their nodes.

    Parameters
    ----------
    effect, law : str
        Their names.
    places : tuple of int
        Of its candidates, shapes ascending.
    nodes : tuple of float
        Normal quantiles of the shape.
    log_weight : float
        Of the law among those of the effect.
    """

    effect: str
    law: str
    places: tuple[int, ...]
    nodes: tuple[float, ...]
    log_weight: float

    @property
    def has_shape(self) -> bool:
        """Whether there is a shape to choose."""
        return len(self.nodes) > 1

    @cached_property
    def _spline(self) -> "scipy.interpolate.BSpline":
        return scipy.interpolate.make_interp_spline(self.nodes, np.eye(len(self.nodes)), k=5)

    def weights(self, shape: Array) -> Array:
        """Return the mixture of candidates at shapes, (…, nodes)."""
        if not self.has_shape:
            return np.ones((*np.shape(shape), 1))
        return np.asarray(self._spline(np.clip(shape, self.nodes[0], self.nodes[-1])))


@dataclass(frozen=True)
class Acting:
    """Effects that act together, a law and a shape of each.

    Parameters
    ----------
    laws : tuple of Law
        Of effects with columns.
    shapes : tuple of float
        Normal quantile of each's shape.
    phases : tuple of Law
        Of effects with phases.
    """

    laws: tuple[Law, ...] = ()
    shapes: tuple[float, ...] = ()
    phases: tuple[Law, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Of the effects."""
        return tuple(sorted(law.effect for law in (*self.laws, *self.phases)))


@dataclass(frozen=True)
class At:
    """A hypothesis at one noise.

    Parameters
    ----------
    psi : ndarray
        Logarithms of the noise.
    value : float
        Log density of data and noise; numbers integrated out.
    gradient : ndarray or None
        Of it.
    information : Information
        On the numbers.
    mean, covariance : ndarray
        Of the numbers, given the data.
    at_mode : bool
        Whether a climb has found no more to gain.
    """

    psi: Array
    value: float
    gradient: Array | None
    information: Information
    mean: Array
    covariance: Array
    at_mode: bool = False


def phase_name(law: Law) -> str:
    """Return what the amplitude of an effect with phases is called among the noise."""
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
    """Return a book of laws in which the first of each class of effects has the laws of all.

    Parameters
    ----------
    laws_of : mapping of str to tuple of Law
        As :func:`lawbook` returns it.
    members : sequence of sequence of str
        Effects that no data tell apart, class by class.
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

"""Errors of the law of an effect: its other functional forms.

The law of an effect is one of several forms: friction may grow with a power of speed instead of in
proportion to it, a drift may saturate, slip may grow with travel. The error is relative to the
force of the effect and varies along the axes of the effect. Along each axis it is a sum of
Legendre polynomials. Their argument is the quantile of the squared effect, so that they are large
only where the effect is. Higher degrees have a smaller variance, and the mean belongs to the
amplitude. The diagnosis averages over the size of the error, along all axes or along speed alone.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import legendre

from bayesfric.arrays import Array
from bayesfric.diagnosis.discrepancy import relative_rms
from bayesfric.effects import ActsOn, Effect, Law
from bayesfric.effects.candidates import Candidate, has_no_equivalent_force, unit_values
from bayesfric.observation.linear import LinearRows
from bayesfric.rigs.base import Unsupported

FORCE_AXES = (
    "speed_m_s",
    "tension_n",
    "n_pulleys",
    "wrap_angle_deg",
    "travel_m",
    "order",
    "trial_in_setup",
)
AXES: Mapping[ActsOn, tuple[str, ...]] = {
    "friction": FORCE_AXES,
    "drive": FORCE_AXES,
    "reading": ("displacement_m", "speed_m_s", "acceleration_m_s2"),
    "current": ("speed_m_s", "load_current_a", "order"),
}
HIGHEST = 3  # degree
UNLIKE = 0.05  # least part of a polynomial's rms that lower degrees must leave unexplained
SHARES = (0.0, 0.03, 0.1, 0.3)
"""Possible relative errors of laws, with equal prior probabilities."""


class FormShare(NamedTuple):
    """Relative error of a law, along one axis, or along every axis (None)."""

    size: float = 0.0
    axis: str | None = None


AS_IT_IS = FormShare()


class Form(NamedTuple):
    """An error of a law: the effect times a polynomial, and its sd at a relative error of 1."""

    candidate: Candidate
    sd: float
    axis: str


def other_forms(
    rows: Sequence[LinearRows], acting: Sequence[tuple[Candidate, float]]
) -> list[Form]:
    """Return the errors of laws along each axis.

    Parameters
    ----------
    rows : sequence of LinearRows
        The rigs.
    acting : sequence of (Candidate, float)
        Effects that act, with their amplitudes. Errors of readings that alternate along the travel
        have no error of their law, because they have no equivalent force; exact laws have none.
    """
    forms: list[Form] = []
    for candidate, amplitude in acting:
        if candidate.effect.is_exact or has_no_equivalent_force(candidate.effect) or amplitude == 0:
            continue
        places = _places(rows, candidate)
        for axis in AXES[candidate.effect.acts_on]:
            shapes = _shapes(*_along(axis, places))
            # The effect itself, on the boards that have the axis.
            alike = replace(candidate, effect=_varied(candidate.effect, axis, np.ones_like))
            size = _size(rows, alike) * abs(amplitude)
            weights = 1 / np.arange(1, len(shapes) + 1)
            for shape, weight in zip(shapes, weights / np.linalg.norm(weights), strict=True):
                varied_candidate = replace(candidate, effect=_varied(candidate.effect, axis, shape))
                if (varied := _size(rows, varied_candidate)) > 0:
                    forms.append(Form(varied_candidate, weight * size / varied, axis))
    return forms


def _size(rows: Sequence[LinearRows], candidate: Candidate) -> float:
    """Return the rms response to amplitude 1; for an error of readings, in metres."""
    if candidate.effect.acts_on != "reading":
        return relative_rms(rows, candidate)
    return max(
        (rig_rows.size_of(candidate) for rig_rows in rows if _shows(rig_rows, candidate)),
        default=0.0,
    )


def _shows(rows: LinearRows, candidate: Candidate) -> bool:
    return not isinstance(rows.where(candidate.effect.acts_on), Unsupported)


def _varied(effect: Effect, axis: str, shape: Callable[[Array], Array]) -> Effect:
    """Return the effect times a polynomial along an axis."""

    def varied(law: Law) -> Law:
        def product(values: Mapping[str, Any], where: Any) -> Array:
            if not _has(where, axis):
                return np.zeros_like(law(values, where), dtype=np.float64)
            place = np.asarray(getattr(where, axis), dtype=np.float64)
            return np.asarray(law(values, where)) * shape(place)

        return product

    return replace(effect, laws={name: varied(law) for name, law in effect.laws.items()})


def _has(where: Any, axis: str) -> bool:
    """Return whether an axis has a meaning; travel has none in a steady run."""
    return not (axis == "travel_m" and where.steady)


def _shapes(at: Array, weight: Array) -> list[Callable[[Array], Array]]:
    """Return polynomials along an axis that lower degrees do not explain."""
    levels, which = np.unique(at, return_inverse=True)
    square = np.bincount(which, weights=weight)
    # An effect that is zero at all levels but one (a curvature around the middle level) cannot
    # vary along the axis.
    if np.count_nonzero(square) < 2:
        return []
    # Other forms vanish where the effect vanishes; equal parts of its square have equal weight.
    quantiles = (np.cumsum(square) - square / 2) / square.sum()
    inside, root = quantiles[which], np.sqrt(weight)
    functions = [root]
    shapes: list[Callable[[Array], Array]] = []
    for degree in range(1, HIGHEST + 1):
        basis = legendre.Legendre.basis(degree, domain=(0.0, 1.0))
        values = root * basis(inside)
        lower = np.stack(functions, axis=1)
        new = values - lower @ np.linalg.lstsq(lower, values, rcond=None)[0]
        # With few levels, or zeros of the effect, a polynomial can equal those of lower degree.
        if np.linalg.norm(new) <= UNLIKE * np.linalg.norm(values):
            continue
        functions.append(values)
        mean = np.average(basis(inside), weights=weight)

        def shape(place: Array, basis: Any = basis, mean: float = mean) -> Array:
            return np.asarray(basis(np.interp(place, levels, quantiles)) - mean)

        shapes.append(shape)
    return shapes


def _places(rows: Sequence[LinearRows], candidate: Candidate) -> list[tuple[Any, Array]]:
    """Return the states of each rig, and the squared effect in them."""
    effect = candidate.effect
    places = [rig_rows.where(effect.acts_on) for rig_rows in rows if _shows(rig_rows, candidate)]
    values, _ = unit_values(candidate)
    law = effect.laws[candidate.law]
    return [(place, np.asarray(law(values, place), dtype=np.float64) ** 2) for place in places]


def _along(axis: str, places: Sequence[tuple[Any, Array]]) -> tuple[Array, Array]:
    """Return values along an axis and their weights; all rigs have the same weight."""
    at, weight = [np.empty(0)], [np.empty(0)]
    for place, square in places:
        if _has(place, axis):
            values = np.asarray(getattr(place, axis), dtype=np.float64)
            along, there = np.broadcast_arrays(values, square)
            at.append(along.ravel())
            weight.append(there.ravel() / there.size)
    return np.concatenate(at), np.concatenate(weight)

"""Columns of the numbers of a hypothesis, and of the scatter, for the rows of a rig."""

from abc import abstractmethod
from copy import copy
from typing import ClassVar, Self

import numpy as np

from bayesfric.arrays import Array
from bayesfric.effects import ActsOn
from bayesfric.effects.candidates import Candidate, on_friction, unit_response
from bayesfric.inference.smooths import Smooth
from bayesfric.observation.layout import Layout, ModelColumns
from bayesfric.observation.linear import LinearRig, LinearRows
from bayesfric.observation.unsupported import Unsupported


class LaidRows(LinearRows):
    """E rows of N trials, linearised around a reference law, with their columns."""

    unseen_phases: ClassVar[Unsupported]
    """Why effects whose phase nobody recorded are not seen."""

    @abstractmethod
    def coefficient_columns(self) -> Array:
        """Return the derivatives of each row by c1, c2 and c3, (E, 3)."""

    @abstractmethod
    def smooth_columns(self, smooth: Smooth, force_n: Array) -> Array:
        """Return a smooth force's columns, (E, k), in units `force_n` (N,) unless relative."""

    @abstractmethod
    def added(self, acts_on: ActsOn, size: Array) -> Array:
        """Return the change of each row by a force or another quantity, (E,)."""

    def candidate_column(self, candidate: Candidate) -> Array | Unsupported:
        """Return the change of each row by an effect of amplitude 1, (E,)."""
        effect = candidate.effect
        where = self.where(effect.acts_on)
        if isinstance(where, Unsupported):
            return where
        if effect.components:
            return self.unseen_phases
        return self.added(effect.acts_on, unit_response(candidate, where))

    @abstractmethod
    def nuisance_columns(self) -> Array:
        """Return the columns of the rig's nuisances, (E, K)."""

    @abstractmethod
    def scatter_column(self) -> Array:
        """Return the change of each row by a relative deviation of friction of 1, (E,)."""


class ColumnsPart(LinearRig):
    """A linear rig that stores the columns of its local numbers, (E, q)."""

    columns: Array

    def mixed(self, mixing: Array) -> Array:
        """Return the columns of a hypothesis, (E, k).

        Parameters
        ----------
        mixing : ndarray, shape (candidates, effects)
            Column of each acting effect, as a combination of candidates.
        """
        start, end = self.layout.own, self.layout.own + self.layout.candidates
        whole = self.columns
        return np.concatenate([whole[:, :start], whole[:, start:end] @ mixing, whole[:, end:]], 1)

    def squeezed(self, squeeze: Array, layout: Layout) -> Self:
        """Return the rig with combinations of its columns instead of them."""
        squeezed = copy(self)
        squeezed.layout, squeezed.columns = layout, self.columns @ squeeze
        return squeezed


def laid_columns(rows: LaidRows, model: ModelColumns, place: int) -> Array:
    """Return the local columns of rows in units of their scales, (E, q).

    Parameters
    ----------
    rows : LaidRows
        E rows.
    model : ModelColumns
        Specification of the columns.
    place : int
        Index of the rig.
    """
    force = np.array([model.friction_scale[size] for size in rows.table["pulley_size"]])
    columns = model.filled(
        rows.name,
        rows.coefficient_columns(),
        lambda smooth: rows.smooth_columns(smooth, force),
        rows.candidate_column,
    )
    columns[:, model.layout.nuisance(place)] = rows.nuisance_columns()
    columns *= model.scales
    return columns


def scattering_column(rows: LaidRows, model: ModelColumns) -> Array:
    """Return the change of rows by a deviation of 1 of friction and its effects, (E,)."""
    moved = rows.scatter_column()
    for candidate, amplitude in on_friction(model.scattering):
        column = rows.candidate_column(candidate)
        if not isinstance(column, Unsupported):
            moved = moved + amplitude * column
    return moved


def row_weights(rows: LaidRows, model: ModelColumns, count: int) -> Array:
    """Return the factor of the precision of each row's own error, (E,)."""
    return np.asarray(model.row_weights.get(rows.name, np.ones(count)), dtype=np.float64)

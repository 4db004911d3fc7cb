"""What the rows of every rig have in common as information on the numbers of a hypothesis."""

from collections.abc import Iterable, Mapping
from copy import copy
from typing import Protocol, Self

import numpy as np
import pandas as pd

from bayesfric.arrays import Array
from bayesfric.effects.candidates import Candidate, on_friction
from bayesfric.inference.information import Information
from bayesfric.inference.smooths import Smooth
from bayesfric.observation.layout import Layout, ModelColumns
from bayesfric.observation.linear import Run
from bayesfric.observation.unsupported import Unsupported


class LaidRows(Protocol):
    """E rows of N trials around a reference law, of which columns can be made."""

    @property
    def name(self) -> str:
        """Of the rig."""

    @property
    def table(self) -> pd.DataFrame:
        """One row a trial."""

    def coefficient_columns(self) -> Array:
        """Return what c1, c2 and c3 add to each row, (E, 3)."""

    def smooth_columns(self, smooth: Smooth, force_n: Array) -> Array:
        """Return what a smooth force adds, in units (N,) unless it is relative, (E, k)."""

    def candidate_column(self, candidate: Candidate) -> Array | Unsupported:
        """Return what an effect of amplitude 1 adds to each row, (E,)."""

    def nuisance_columns(self) -> Array:
        """Return what the rig's own numbers add to each row, (E, K)."""

    def scatter_column(self) -> Array:
        """Return what a relative deviation of friction of 1 adds to each row, (E,)."""


class LinearPart:
    """The trials of a rig as information on the numbers of a hypothesis.

    A rig brings :meth:`~bayesfric.observation.linear.LinearRig.evaluate` and what depends on
    its noise.

    Parameters
    ----------
    table : DataFrame
        N trials.
    model : ModelColumns
        What is made of them.

    Attributes
    ----------
    size, setup : ndarray of int, shape (N,)
        Place of each trial's pulley size, and its assembly.
    layout : Layout
        Where numbers stand.
    """

    def __init__(self, table: pd.DataFrame, model: ModelColumns) -> None:
        self.layout = model.layout
        sizes = table["pulley_size"]
        self.size = np.array([model.layout.sizes.index(size) for size in sizes], dtype=np.intp)
        self.setup = pd.factorize(table["setup"])[0].astype(np.intp)

    def joined(self, of_sizes: Iterable[tuple[int, Array, Array]], constant: float) -> Information:
        """Return what trials of all sizes say of the numbers of all sizes.

        Parameters
        ----------
        of_sizes : iterable of (int, ndarray, ndarray)
            Place of a size, and precision (k, k) and slope (k,) of its local numbers.
        constant : float
            Of all sizes.
        """
        parts = list(of_sizes)
        width = len(parts[0][2])
        total = self.layout.total(width)
        precision, slope = np.zeros((total, total)), np.zeros(total)
        for size, own_precision, own_slope in parts:
            place = self.layout.spread(width, size)
            precision[np.ix_(place, place)] += own_precision
            slope[place] += own_slope
        return Information(precision, slope, constant)

    def phase_strength(self, place: int) -> float:
        """Return the squared signal over noise of phases at unit amplitude: here none shows."""
        del place
        return 0.0

    def runs(self, noise: Mapping[str, float], numbers: Array) -> dict[int, Run]:
        """Return the trials that run freely from their first events: none."""
        del noise, numbers
        return {}


class ColumnsPart(LinearPart):
    """The same with the columns of the local numbers, (E, q), kept as they are."""

    columns: Array

    def mixed(self, mixing: Array) -> Array:
        """Return the columns of a hypothesis whose effects mix candidates, (E, k).

        Parameters
        ----------
        mixing : ndarray, shape (candidates, effects)
            Column of each effect that acts.
        """
        start, end = self.layout.own, self.layout.own + self.layout.candidates
        whole = self.columns
        return np.concatenate([whole[:, :start], whole[:, start:end] @ mixing, whole[:, end:]], 1)

    def squeezed(self, squeeze: Array, layout: Layout) -> Self:
        """Return the rig with mixtures of its columns in their place."""
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
        What is made of them.
    place : int
        Of the rig among all.
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
    """Return what a deviation of 1 of friction, with the effects that act, adds, (E,)."""
    moved = rows.scatter_column()
    for candidate, amplitude in on_friction(model.scattering):
        column = rows.candidate_column(candidate)
        if not isinstance(column, Unsupported):
            moved = moved + amplitude * column
    return moved


def row_weights(rows: LaidRows, model: ModelColumns, count: int) -> Array:
    """Return by what the precision of each row's own error is multiplied, (E,)."""
    return np.asarray(model.row_weights.get(rows.name, np.ones(count)), dtype=np.float64)

"""Smooth forces of the discrepancy and of an unknown force.

The force along a covariate is a zero-mean Gaussian process with the squared exponential kernel;
along two covariates it is a process of both. It is reduced to its leading eigenvectors, so that the
force is linear in a few standard normal coefficients. If a covariate has few values, these are
vectors over its values.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
import scipy
from numpy.typing import NDArray

from bayesfric.arrays import Array

NODES = 25  # points at which a kernel along a continuous covariate is decomposed
BROAD, NARROW, SHARP = 1 / 3, 1 / 6, 1 / 12  # length scales, relative to the range
KEPT, WHOLE = 0.99, 0.999  # part of the variance; the second where data inform most
MOST_SEPARATE_VALUES = 9  # a covariate with at most so many values is discrete
FINE = 50.0  # by which a logarithmic axis is finer at its low end than at its high end


@dataclass(frozen=True)
class Span:
    """The range of a covariate.

    Parameters
    ----------
    low, high : float
        Lowest and highest value.
    values : tuple of float
        Its values if they are few, otherwise none.
    logarithmic : bool
        Whether its scale is logarithmic, finest at its low end.
    """

    low: float
    high: float
    values: tuple[float, ...] = ()
    logarithmic: bool = False

    @classmethod
    def of(cls, *arrays: Array) -> "Span":
        """Return the span of arrays, without NaN."""
        whole = np.concatenate([np.ravel(values) for values in arrays])
        whole = whole[np.isfinite(whole)]
        if not whole.size:
            return cls(0.0, 0.0)
        low, high = float(whole.min()), float(whole.max())
        distinct = np.unique(whole.round(9))
        few = tuple(distinct.tolist()) if distinct.size <= MOST_SEPARATE_VALUES else ()
        return cls(low, high, few)

    def place(self, at: Array) -> Array:
        """Return the positions of values, from 0 at the lowest to 1 at the highest."""
        share = np.clip((at - self.low) / (self.high - self.low), 0.0, 1.0)
        return np.log1p(FINE * share) / np.log1p(FINE) if self.logarithmic else share


@dataclass(frozen=True)
class Smooth:
    """A Gaussian process along one covariate or along two, of unit variance.

    Parameters
    ----------
    axes : tuple of str
        Names of the covariates; none of a constant.
    spans : tuple of Span
        Their ranges.
    kept : ndarray of int, shape (k, len(axes))
        Which eigenvectors of each axis are multiplied.
    length : float
        Length scale, relative to each range.
    rig : str or None
        The only rig that it acts on; None is all.
    relative : bool
        Whether it is a fraction of friction; otherwise a force.
    alone : bool
        Whether an unknown force contains it only by itself, not together with others.
    """

    axes: tuple[str, ...]
    spans: tuple[Span, ...]
    kept: NDArray[np.intp]
    length: float = BROAD
    rig: str | None = None
    relative: bool = False
    alone: bool = False

    @property
    def axis(self) -> str:
        """The first covariate on which the force depends, or the rig."""
        return self.axes[0] if self.axes else "rig"

    @property
    def alike(self) -> bool:
        """Whether it is the same fraction of friction for all sizes, loads and rigs."""
        return self.relative and self.rig is None and len(self.axes) == 1

    @property
    def count(self) -> int:
        """Number of coefficients."""
        return len(self.kept)

    def columns(self, covariates: Mapping[str, Array]) -> Array:
        """Return the functions of the process, shape (k, …), with unit variance in total.

        Parameters
        ----------
        covariates : mapping of str to ndarray
            By name, of shapes that broadcast.
        """
        if not self.axes:
            shape = np.broadcast_shapes(*(np.shape(values) for values in covariates.values()))
            return np.ones((1, *shape))
        tables = [
            _functions(span, self.length, np.asarray(covariates[axis], dtype=np.float64))
            for axis, span in zip(self.axes, self.spans, strict=True)
        ]
        products = []
        for chosen in self.kept:
            product = np.ones(())
            for table, index in zip(tables, chosen, strict=True):
                product = product * table[..., index]
            products.append(product)
        return np.stack(np.broadcast_arrays(*products))


def smooth_along(
    spans: Mapping[str, Span],
    rig: str | None = None,
    *,
    relative: bool = False,
    length: float = BROAD,
    kept: float = KEPT,
) -> Smooth | None:
    """Return the process along covariates, or None if one of them does not vary.

    Parameters
    ----------
    spans : mapping of str to Span
        By covariate; empty for a constant.
    rig : str or None
        The only rig that it acts on.
    relative : bool
        Whether it is a fraction of friction; otherwise a force.
    length : float
        Length scale, relative to each range.
    kept : float
        Part of the variance of the process that the functions contain.
    """
    if any(span.high <= span.low for span in spans.values()):
        return None
    if not spans:
        return Smooth((), (), np.zeros((1, 0), dtype=np.intp), length, rig, relative)
    share = np.ones(())
    for span in spans.values():
        share = np.multiply.outer(share, _values(span, length))
    order = np.argsort(share, axis=None)[::-1]
    count = int(np.searchsorted(np.cumsum(share.ravel()[order]), kept)) + 1
    chosen = np.stack(np.unravel_index(order[:count], share.shape), axis=1)
    return Smooth(tuple(spans), tuple(spans.values()), chosen, length, rig, relative)


def _functions(span: Span, length: float, at: Array) -> Array:
    """Return all eigenfunctions along one covariate at some values, shape (…, K)."""
    place = span.place(at)
    if not span.values:
        return np.asarray(_splines(length)(place))
    levels, _, vectors = _few(span, length)
    table = [np.interp(place, levels, vector) for vector in vectors.T]
    return np.stack(table, axis=-1)


def _values(span: Span, length: float) -> Array:
    values = _few(span, length)[1] if span.values else _kernel(length)[1]
    return np.asarray(values / values.sum())


def _decomposed(grid: Array, length: float) -> tuple[Array, Array]:
    kernel = np.exp(-0.5 * ((grid[:, None] - grid) / length) ** 2)
    values, vectors = np.linalg.eigh(kernel)
    values, vectors = np.maximum(values[::-1], 0.0), vectors[:, ::-1]
    # Fixed signs give the same eigenvectors on every machine.
    signs = np.sign(vectors[np.abs(vectors).argmax(axis=0), np.arange(grid.size)])
    return values, vectors * signs * np.sqrt(values)


@cache
def _few(span: Span, length: float) -> tuple[Array, Array, Array]:
    levels = span.place(np.array(span.values))
    return levels, *_decomposed(levels, length)


@cache
def _kernel(length: float) -> tuple[Array, Array, Array]:
    grid = np.linspace(0, 1, NODES)
    return grid, *_decomposed(grid, length)


@cache
def _splines(length: float) -> "scipy.interpolate.BSpline":
    grid, _, vectors = _kernel(length)
    return scipy.interpolate.make_interp_spline(grid, vectors, k=3)

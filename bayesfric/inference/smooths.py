"""Smooth forces that nobody named: the discrepancy of every hypothesis.

A force along each covariate is a zero-mean Gaussian process with the squared
exponential kernel and a length scale of a third of the covariate's range; along speed
by tension it is a process of both. A plate, a worn spot, a day or a load of spinning up
changes all friction in proportion: along the number of pulleys, displacement, order and
acceleration a process of half that length scale is a share of friction, and so is a
constant of the motor board. Each is reduced to its leading eigenvectors, so that the force
is linear in a few standard normal numbers. The processes share the variance equally.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline, make_interp_spline

__all__ = ["Smooth", "smooth_along"]

Array = NDArray[np.float64]
NODES = 25
BROAD, NARROW = 1 / 3, 1 / 6  # length scales, as shares of the range
KEPT = 0.995  # of a process' variance


@dataclass(frozen=True)
class Smooth:
    """A Gaussian process along one covariate or along two.

    Parameters
    ----------
    axes : tuple of str
        Names of the covariates; none of a constant.
    ranges : tuple of (float, float)
        Lowest and highest value of each.
    kept : ndarray of int, shape (k, len(axes))
        Which eigenvectors of each axis are multiplied.
    rig : {"gravity", "motor"} or None
        The only board that it acts on; None is both.
    relative : bool
        Whether it is a share of friction, and narrow; else a force, and broad.
    """

    axes: tuple[str, ...]
    ranges: tuple[tuple[float, float], ...]
    kept: NDArray[np.intp]
    rig: str | None = None
    relative: bool = False

    @property
    def length(self) -> float:
        """Length scale, as a share of each range."""
        return NARROW if self.relative else BROAD

    @property
    def axis(self) -> str:
        """What the force depends on: the first covariate, or the rig."""
        return "rig" if self.rig == "motor" else self.axes[0]

    @property
    def count(self) -> int:
        """Numbers of the process."""
        return len(self.kept)

    def columns(self, covariates: Mapping[str, Array]) -> Array:
        """Return the process' functions, shape (k, …), of unit variance in all.

        Parameters
        ----------
        covariates : mapping of str to ndarray
            By name, of shapes that broadcast.
        """
        tables = [
            _eigenfunctions(self.length)(_place(covariates[axis], limits))
            for axis, limits in zip(self.axes, self.ranges, strict=True)
        ]
        if not self.axes:
            shape = np.broadcast_shapes(*(np.shape(values) for values in covariates.values()))
            return np.ones((1, *shape))
        products = []
        for chosen in self.kept:
            product = np.ones(())
            for table, index in zip(tables, chosen, strict=True):
                product = product * table[..., index]
            products.append(product)
        return np.stack(np.broadcast_arrays(*products))


def smooth_along(
    ranges: Mapping[str, tuple[float, float]], rig: str | None = None, *, relative: bool = False
) -> Smooth | None:
    """Return the process along covariates, or None where one of them does not vary.

    Parameters
    ----------
    ranges : mapping of str to (float, float)
        Lowest and highest value by covariate; empty of a constant.
    rig : {"gravity", "motor"} or None
        The only board that it acts on.
    relative : bool
        Whether it is a share of friction, and narrow; else a force, and broad.
    """
    if any(high <= low for low, high in ranges.values()):
        return None
    if not ranges:
        return Smooth((), (), np.zeros((1, 0), dtype=np.intp), rig, relative)
    length = NARROW if relative else BROAD
    share = _eigenvalues(length)
    for _ in range(len(ranges) - 1):
        share = np.multiply.outer(share, _eigenvalues(length))
    order = np.argsort(share, axis=None)[::-1]
    count = int(np.searchsorted(np.cumsum(share.ravel()[order]), KEPT)) + 1
    kept = np.stack(np.unravel_index(order[:count], share.shape), axis=1)
    return Smooth(tuple(ranges), tuple(ranges.values()), kept, rig, relative)


def _place(values: Array, limits: tuple[float, float]) -> Array:
    low, high = limits
    return np.clip((np.asarray(values, dtype=np.float64) - low) / (high - low), 0.0, 1.0)


@cache
def _kernel(length: float) -> tuple[Array, Array, Array]:
    grid = np.linspace(0, 1, NODES)
    kernel = np.exp(-0.5 * ((grid[:, None] - grid) / length) ** 2)
    values, vectors = np.linalg.eigh(kernel)
    return grid, np.maximum(values[::-1], 0.0), vectors[:, ::-1]


def _eigenvalues(length: float) -> Array:
    values = _kernel(length)[1]
    return np.asarray(values / values.sum())


@cache
def _eigenfunctions(length: float) -> BSpline:
    grid, values, vectors = _kernel(length)
    # Signs are settled, so that one machine's eigenvectors are another's.
    signs = np.sign(vectors[np.abs(vectors).argmax(axis=0), np.arange(NODES)])
    return make_interp_spline(grid, vectors * signs * np.sqrt(values), k=3)

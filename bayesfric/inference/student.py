"""Student-t scatter of single measurements: the robust alternative to :mod:`.grouped_normal`.

Each group has one or two deviations with priors N(0, 1), which shift the means of its measurements.
Given the deviations, a measurement has a Student-t density. Its scale may include the variance of a
normal error; this is exact in the limit of a small error, as that of Hall events is. The deviations
are integrated out by the trapezoid rule on a grid around their posterior.
"""

from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaln, logsumexp, stdtr

from bayesfric.arrays import Array
from bayesfric.inference.grouped_normal import LOG_2PI, Grouped
from bayesfric.inference.quadratic import gram, matrices

REWEIGHTINGS = 12  # iterations of the search for the mode


class _Nodes(NamedTuple):
    """A grid along each deviation of a group; its half-width is in standard deviations."""

    number: int
    half_width: float


# Steps are 0.4, 0.93, 0.1 and 0.7 standard deviations: the rule converges exponentially.
GROUP_NODES = {1: _Nodes(41, 8.0), 2: _Nodes(15, 6.5)}
SINGLE_NODES = {1: _Nodes(161, 8.0), 2: _Nodes(21, 7.0)}


def log_density_given(together: Array, single: Array) -> Array:
    """Return the log density of each measurement given the others of its group, (W, M).

    Parameters
    ----------
    together : ndarray, shape (Q, W, M)
        Log density of its whole group at Q nodes, plus the log weight of the node.
    single : ndarray, shape (Q, W, M)
        Log density of the measurement alone at the nodes.
    """
    return np.asarray(logsumexp(together, axis=0) - logsumexp(together - single, axis=0))


def weight_given(together: Array, single: Array) -> Array:
    """Return the probability of each node given the other measurements, shape (Q, W, M).

    Parameters are those of :func:`log_density_given`.
    """
    rest = together - single
    weight = np.exp(rest - rest.max(axis=0))
    return np.asarray(weight / weight.sum(axis=0))


def drawn_node(weight: Array, rng: np.random.Generator) -> NDArray[np.intp]:
    """Draw a node for each measurement by the nodes' probabilities, shape (1, W, M)."""
    below = (weight.cumsum(axis=0) < rng.uniform(size=weight.shape[1:])).sum(axis=0)
    return np.asarray(np.minimum(below, len(weight) - 1)[None])


@dataclass(frozen=True)
class GroupedStudent(Grouped):
    """Measurements with Student-t densities, in groups with one or two deviations.

    Parameters
    ----------
    freedom : float
        Degrees of freedom of the measurements' densities.
    """

    freedom: float

    def group_log_density(self) -> Array:
        """Return the log density of each group, shape (W, G)."""
        log_weight, single, _ = self._on_grid(GROUP_NODES[len(self.moved)], leave_out=False)
        return np.asarray(logsumexp(log_weight + self.groups.total(single), axis=0))

    def single_log_density(self) -> Array:
        """Return the log density of each measurement given the others of its group, (W, M).

        A single measurement of a group has the density of the group. The wider grid of the other
        measurements could miss its peak, which is narrow if the scale is small against the shifts
        by the deviations. This error remains in a group of two whose measurements are shifted by
        different amounts: it is 0.1 nat if the scale is a fifth of the shift.
        """
        log_weight, single, _ = self._on_grid(SINGLE_NODES[len(self.moved)], leave_out=True)
        together = (log_weight + self.groups.total(single))[..., self.groups.of_each]
        density = log_density_given(together, single)
        groups = self.groups
        alone = np.flatnonzero(np.diff(groups.starts, append=groups.count) == 1)
        if alone.size:
            density[..., groups.starts[alone]] = self.group_log_density()[..., alone]
        return density

    def single_cdf(self) -> Array:
        """Return each measurement's distribution function given the others of its group, (W, M)."""
        weight, distance = self._given_the_rest()
        return np.asarray((weight * stdtr(self.freedom, distance)).sum(axis=0))

    def draw_again(self, rng: np.random.Generator) -> Array:
        """Draw each measurement anew given all others of its group, minus its measured value.

        Parameters
        ----------
        rng : Generator
            Source of randomness.

        Returns
        -------
        ndarray, shape (W, M)
        """
        weight, distance = self._given_the_rest()
        node = drawn_node(weight, rng)
        centre = np.take_along_axis(distance, node, axis=0)[0]
        again = rng.standard_t(self.freedom, centre.shape)
        return np.asarray(np.sqrt(self.variance) * (again - centre))

    def _given_the_rest(self) -> tuple[Array, Array]:
        """Return probabilities of nodes given the others, and standardised residuals, (Q, W, M)."""
        nodes = SINGLE_NODES[len(self.moved)]
        log_weight, single, distance = self._on_grid(nodes, leave_out=True)
        together = (log_weight + self.groups.total(single))[..., self.groups.of_each]
        return weight_given(together, single), distance

    def _on_grid(self, nodes: _Nodes, *, leave_out: bool) -> tuple[Array, Array, Array]:
        """Return log weights, log densities of measurements and their standardised residuals.

        Returns
        -------
        log_weight : ndarray, shape (Q, W, G)
            Log of the weight of each node times its prior density.
        single, distance : ndarray, shape (Q, W, M)
            Log density of each measurement, and its residual over its scale, at each node.
        """
        rank, of_each = len(self.moved), self.groups.of_each
        centre, information = self._mode(leave_out=leave_out)
        spread = np.linalg.cholesky(np.linalg.inv(information))  # (W, G, R, R)
        grid = np.linspace(-nodes.half_width, nodes.half_width, nodes.number)
        place = np.array(list(product(grid, repeat=rank)))  # (Q, R)
        numbers = centre[..., None] + spread @ place.T  # (W, G, R, Q)
        numbers = np.moveaxis(numbers, (-1, -2), (0, 1))  # (Q, R, W, G)
        volume = np.log(np.diagonal(spread, axis1=-2, axis2=-1)).sum(axis=-1)
        volume = volume + rank * np.log(grid[1] - grid[0])
        log_weight = volume - 0.5 * (rank * LOG_2PI + (numbers**2).sum(axis=1))
        off = self.residual - (self.moved * numbers[..., of_each]).sum(axis=1)
        distance = off / np.sqrt(self.variance)
        single = (
            gammaln((self.freedom + 1) / 2)
            - gammaln(self.freedom / 2)
            - 0.5 * np.log(self.freedom * np.pi * self.variance)
            - 0.5 * (self.freedom + 1) * np.log1p(distance**2 / self.freedom)
        )
        return log_weight, single, distance

    def _mode(self, *, leave_out: bool) -> tuple[Array, Array]:
        """Return the mode of each group's deviations, (W, G, R), and their information matrix.

        The mode is found by iteratively reweighted least squares. With `leave_out`, the information
        is that without the most informative measurement. The grid is then wide enough for the
        deviations given all but any one measurement.
        """
        groups, moved = self.groups, self.moved
        centre = np.zeros((*self.residual.shape[:-1], groups.starts.size, len(moved)))
        for _ in range(REWEIGHTINGS):
            off = self.residual - (moved * np.moveaxis(centre, -1, 0)[..., groups.of_each]).sum(0)
            weight = (self.freedom + 1) / (self.freedom + off**2 / self.variance) / self.variance
            matrix = matrices(gram([*moved, self.residual], weight, groups.total))
            information = np.eye(len(moved)) + matrix[..., :-1, :-1]
            centre = np.linalg.solve(information, matrix[..., :-1, -1:])[..., 0]
        if leave_out:
            information_of_each = weight * (moved**2).sum(axis=0)
            most = np.maximum.reduceat(information_of_each, groups.starts, axis=-1)[
                ..., groups.of_each
            ]
            rest = gram(
                list(moved), np.where(information_of_each == most, 0.0, weight), groups.total
            )
            information = np.eye(len(moved)) + matrices(rest)
        return centre, information

"""Groups whose own numbers are Student-t: :mod:`.grouped_normal` over widths of each group.

The numbers that a group draws are normal with a variance over λ, which the group draws first,
λ ~ Γ(ν/2, ν/2): together they are Student-t, so that a group that is far out forgives itself.
Given λ all is one normal; λ is integrated by the trapezoid rule in its logarithm.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import stats
from scipy.special import logsumexp

from bayesfric.inference.grouped_normal import LOG_2PI, GroupedNormal, Groups
from bayesfric.inference.quadratic import eliminate, gram

__all__ = ["HeavyGroups"]

Array = NDArray[np.float64]
NODES = 41  # in log λ: the rule converges exponentially
LOWER, UPPER = 1e-12, 1e-8  # probability beyond the grid; groups far out are at its lower end


@dataclass(frozen=True)
class HeavyGroups:
    """M measurements in G groups, for W sets of parameters at once.

    Parameters
    ----------
    groups : Groups
        Of the measurements.
    residual : ndarray, shape (W, M)
        What was measured less its mean.
    variance : ndarray, shape (W, M)
        Of the errors that each measurement has to itself.
    moved : ndarray, shape (R, W, M)
        By how much one scale of each of a group's R numbers moves a measurement.
    freedom : float
        Degrees of freedom.
    """

    groups: Groups
    residual: Array
    variance: Array
    moved: Array
    freedom: float

    def group_log_density(self) -> Array:
        """Return the log density of each group, shape (W, G)."""
        return np.asarray(logsumexp(self._group, axis=0))

    def single_log_density(self) -> Array:
        """Return the log density of each measurement given its group's others, (W, M)."""
        single = np.stack([one.single_log_density() for one in self._normals])
        together = self._group[..., self.groups.of_each]
        return np.asarray(logsumexp(together, axis=0) - logsumexp(together - single, axis=0))

    def single_cdf(self) -> Array:
        """Return the probability of less of each measurement given its group's others, (W, M)."""
        below = np.stack([one.single_cdf() for one in self._normals])
        return np.asarray((self._given_the_rest() * below).sum(axis=0))

    def draw_again(self, rng: np.random.Generator) -> Array:
        """Draw by how much each measurement would be more if it alone were made again, (W, M).

        Parameters
        ----------
        rng : Generator
            Source of randomness.
        """
        weight = self._given_the_rest()
        below = (weight.cumsum(axis=0) < rng.uniform(size=weight.shape[1:])).sum(axis=0)
        again = np.stack([one.draw_again(rng) for one in self._normals])
        node = np.minimum(below, len(weight) - 1)[None]
        return np.asarray(np.take_along_axis(again, node, axis=0)[0])

    @cached_property
    def _nodes(self) -> tuple[Array, Array]:
        """Return λ at the nodes and the log weight of each, shape (Q,)."""
        width = stats.gamma(self.freedom / 2, scale=2 / self.freedom)
        low, high = np.log([width.ppf(LOWER), width.isf(UPPER)])
        log = np.linspace(low, high, NODES)
        log_weight = width.logpdf(np.exp(log)) + log
        return np.exp(log), log_weight - logsumexp(log_weight)

    @cached_property
    def _normals(self) -> list[GroupedNormal]:
        scales = 1 / np.sqrt(self._nodes[0])
        return [
            GroupedNormal(self.groups, self.residual, self.variance, scale * self.moved)
            for scale in scales
        ]

    @cached_property
    def _group(self) -> Array:
        """Log density of each group and node, weighed, shape (Q, W, G)."""
        width, log_weight = self._nodes
        form = gram([*self.moved, self.residual], 1 / self.variance, self.groups.total)
        form = np.broadcast_to(form[:, None], (len(form), len(width), *form.shape[1:]))
        numbers = [1 / width[:, None, None]] * len(self.moved)
        form, log_determinant = eliminate(form, numbers)
        own = self.groups.total(LOG_2PI + np.log(self.variance))
        density = -0.5 * (own + log_determinant + form[-1])
        return np.asarray(density + log_weight[:, None, None])

    def _given_the_rest(self) -> Array:
        """Return the probability of each node given a group's others, shape (Q, W, M)."""
        single = np.stack([one.single_log_density() for one in self._normals])
        rest = self._group[..., self.groups.of_each] - single
        weight = np.exp(rest - rest.max(axis=0))
        return np.asarray(weight / weight.sum(axis=0))

"""Groups with Student-t deviations: a mixture of :mod:`.grouped_normal` over variances.

Each group has a precision λ ~ Γ(ν/2, ν/2). Given λ, its deviations are normal with variance 1/λ.
Without λ they have a multivariate Student-t distribution. So an outlying group has less influence
on the law and on the scatter than with normal deviations. λ is integrated out by the trapezoid rule
in its logarithm.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy
from scipy.special import logsumexp

from bayesfric.arrays import Array
from bayesfric.inference.grouped_normal import LOG_2PI, Grouped, GroupedNormal
from bayesfric.inference.quadratic import eliminate, gram
from bayesfric.inference.student import drawn_node, log_density_given, weight_given

NODES = 41  # nodes in log λ; the rule converges exponentially
LOWER, UPPER = 1e-12, 1e-8  # probabilities of λ beyond the grid; outlying groups have small λ


@dataclass(frozen=True)
class HeavyGroups(Grouped):
    """Normal measurements in groups with Student-t deviations.

    Parameters
    ----------
    freedom : float
        Degrees of freedom of the groups' deviations.
    """

    freedom: float

    def group_log_density(self) -> Array:
        """Return the log density of each group, shape (W, G)."""
        return np.asarray(logsumexp(self._group, axis=0))

    def single_log_density(self) -> Array:
        """Return the log density of each measurement given the others of its group, (W, M)."""
        return log_density_given(self._group[..., self.groups.of_each], self._single)

    def single_cdf(self) -> Array:
        """Return each measurement's distribution function given the others of its group, (W, M)."""
        below = np.stack([normal.single_cdf() for normal in self._normals])
        return np.asarray((self._given_the_rest() * below).sum(axis=0))

    def draw_again(self, rng: np.random.Generator) -> Array:
        """Draw a replicate of each measurement given all others, minus its own value, (W, M).

        Parameters
        ----------
        rng : Generator
            Source of randomness.
        """
        node = drawn_node(self._given_the_rest(), rng)
        again = np.stack([normal.draw_again(rng) for normal in self._normals])
        return np.asarray(np.take_along_axis(again, node, axis=0)[0])

    @cached_property
    def _nodes(self) -> tuple[Array, Array]:
        """Return λ at the nodes and the log weight of each, shape (Q,)."""
        width = scipy.stats.gamma(self.freedom / 2, scale=2 / self.freedom)
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
        """Weighted log density of each group and node, shape (Q, W, G)."""
        width, log_weight = self._nodes
        form = gram([*self.moved, self.residual], 1 / self.variance, self.groups.total)
        form = np.broadcast_to(form[:, None], (len(form), len(width), *form.shape[1:]))
        numbers = [1 / width[:, None, None]] * len(self.moved)
        form, log_determinant = eliminate(form, numbers)
        own = self.groups.total(LOG_2PI + np.log(self.variance))
        density = -0.5 * (own + log_determinant + form[-1])
        return np.asarray(density + log_weight[:, None, None])

    def _given_the_rest(self) -> Array:
        """Return the probability of each node given the other measurements, shape (Q, W, M)."""
        return weight_given(self._group[..., self.groups.of_each], self._single)

    @property
    def _single(self) -> Array:
        """Log density of each measurement given the others of its group and λ, (Q, W, M)."""
        return np.stack([normal.single_log_density() for normal in self._normals])

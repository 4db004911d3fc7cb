"""What follows of a likelihood that is one grouped normal of its trials."""

from abc import ABC, abstractmethod
from collections.abc import Mapping

import numpy as np

from bayesfric.arrays import Array
from bayesfric.inference.grouped_normal import GroupedNormal
from bayesfric.inference.model import GivenRest

__all__ = ["GroupedLikelihood", "given_rest"]


class GroupedLikelihood(ABC):
    """A likelihood whose trials, given the parameters, are one :class:`GroupedNormal`."""

    @abstractmethod
    def normal(self, theta: Mapping[str, Array]) -> GroupedNormal:
        """Return the normal of W sets of parameters."""

    def log_likelihood(self, theta: Mapping[str, Array]) -> Array:
        """Return the log density of all readings, shape (W,)."""
        return self.normal(theta).log_density()

    def setup_log_likelihood(self, theta: Mapping[str, Array]) -> Array:
        """Return each assembly's log density given the others, shape (W, J)."""
        return self.normal(theta).group_log_density()

    def given_rest(
        self, theta: Mapping[str, Array], rng: np.random.Generator | None = None
    ) -> GivenRest:
        """Return densities and probabilities of each trial and assembly given the others."""
        return given_rest(self.normal(theta), rng)

    def draw_trial_cdf(self, theta: Mapping[str, Array], rng: np.random.Generator) -> Array:
        """Return the probability of less friction than each trial's, made again, (W, N)."""
        return self.normal(theta).drawn(rng).single_cdf()


def given_rest(normal: GroupedNormal, rng: np.random.Generator | None = None) -> GivenRest:
    """Return what a normal of trials says of each trial and assembly given the others."""
    return GivenRest(
        normal.single_log_density(),
        normal.group_log_density(),
        normal.single_cdf(),
        normal.group_cdf(),
        normal.residual[:, :0] if rng is None else normal.draw_again(rng),
    )

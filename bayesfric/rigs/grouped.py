"""What follows of a likelihood that is one grouped normal of its trials."""

from abc import ABC, abstractmethod
from collections.abc import Mapping

import numpy as np

from bayesfric.arrays import Array
from bayesfric.inference.grouped_normal import GroupedNormal

__all__ = ["GroupedLikelihood"]


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

    def trial_log_likelihood(self, theta: Mapping[str, Array]) -> Array:
        """Return each trial's log density given the others, shape (W, N)."""
        return self.normal(theta).single_log_density()

    def draw_again(self, theta: Mapping[str, Array], rng: np.random.Generator) -> Array:
        """Return how much more each trial would read, made again given the others, (W, N)."""
        return self.normal(theta).draw_again(rng)

    def setup_cdf(self, theta: Mapping[str, Array]) -> Array:
        """Return the probability of less friction of each assembly given the others, (W, J)."""
        return self.normal(theta).group_cdf()

    def trial_cdf(self, theta: Mapping[str, Array]) -> Array:
        """Return the probability of less friction of each trial given the others, (W, N)."""
        return self.normal(theta).single_cdf()

    def draw_trial_cdf(self, theta: Mapping[str, Array], rng: np.random.Generator) -> Array:
        """Return :meth:`trial_cdf` of recordings made again with these parameters, (W, N)."""
        return self.normal(theta).drawn(rng).single_cdf()

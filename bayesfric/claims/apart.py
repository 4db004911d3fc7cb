"""The model of two rigs whose friction differs by an unknown relative amount."""

from collections.abc import Mapping

import numpy as np

from bayesfric.analysis import Priors
from bayesfric.arrays import Array
from bayesfric.inference.model import Model, RigLikelihood
from bayesfric.inference.priors import Parameter
from bayesfric.physics.friction import Coefficients

MEAN = "rig_difference"


class ApartModel(Model):
    """The posterior of a friction law and of the relative difference of a second rig's friction.

    The coefficients of a size on the second rig are 1 + d times those on the first, with
    d = mean + own, the mean over sizes and a deviation of each size. Both are unknown, so sizes
    are pooled as their priors imply; three sizes cannot determine their spread.

    Parameters
    ----------
    first, second : RigLikelihood
        Likelihoods; the first rig has all sizes of the second.
    priors : Priors
        Contains the priors of the mean difference and of a size's deviation.
    """

    def __init__(self, first: RigLikelihood, second: RigLikelihood, priors: Priors) -> None:
        apart = [
            Parameter(MEAN, "1", priors.rig_difference),
            *(Parameter(f"{MEAN}[{s}]", "1", priors.rig_difference_of_size) for s in second.sizes),
        ]
        super().__init__((first, second), apart)
        self._first, self._second = first, second
        self._start = np.append(Model((first, second)).start(), np.zeros(len(apart)))

    def start(self) -> Array:
        """Return a starting point in the sampling space without a difference, shape (D,)."""
        return self._start

    def _log_likelihood(self, theta: Array) -> Array:
        """Return the log density of the raw data of both rigs for as many walkers as fit a cache.

        Shape (W,).
        """
        named = self.by_name(theta)
        own = {
            f"{name}[{size}]": (1 + share) * named[f"{name}[{size}]"]
            for size, share in differences(named, self._second.sizes).items()
            for name in Coefficients._fields
            if f"{name}[{size}]" in named
        }
        return self._first.log_likelihood(named) + self._second.log_likelihood(named | own)


def differences(theta: Mapping[str, Array], sizes: tuple[str, ...]) -> dict[str, Array]:
    """Return the relative difference of the second rig's friction for each size."""
    return {size: theta[MEAN] + theta[f"{MEAN}[{size}]"] for size in sizes}

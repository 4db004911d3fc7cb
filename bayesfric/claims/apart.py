"""The model of two rigs whose friction differs by an unknown relative amount."""

from collections.abc import Mapping

import numpy as np

from bayesfric.analysis import Priors
from bayesfric.arrays import Array
from bayesfric.fitting.drawing import refuse_vanished
from bayesfric.inference.laplace import NoModeError, laplace_approximation
from bayesfric.inference.model import Model, RigLikelihood
from bayesfric.inference.more_data import draws_with_more_data
from bayesfric.inference.priors import LOG_2PI, Parameter
from bayesfric.inference.proposals import Chart
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
        return self._first.log_likelihood(named) + self._of_second(named)

    def _of_second(self, named: Mapping[str, Array]) -> Array:
        """Return the log density of the second rig's raw data, shape (W,)."""
        own = {
            f"{name}[{size}]": (1 + share) * named[f"{name}[{size}]"]
            for size, share in differences(named, self._second.sizes).items()
            for name in Coefficients._fields
            if f"{name}[{size}]" in named
        }
        return self._second.log_likelihood({**named, **own})


class SecondGivenFirst(ApartModel):
    """The same parameters as :class:`ApartModel`, given the data of the second rig alone.

    The first rig's data enter by draws of its parameters. In a point, these come first.
    """

    def __init__(self, first: RigLikelihood, second: RigLikelihood, priors: Priors) -> None:
        super().__init__(first, second, priors)
        self.likelihoods = (second,)
        self._alone = Model((first,))

    def _log_likelihood(self, theta: Array) -> Array:
        return self._of_second(self.by_name(theta))

    def draws(self, of_first: Mapping[str, Array], seed: int, size: int) -> Array | None:
        """Draw from the posterior given the data of both rigs.

        Parameters
        ----------
        of_first : mapping of str to ndarray, shape (S,)
            Draws of the first rig's parameters given its data, in random order.
        seed : int
            Seed of the samples.
        size : int
            Number of draws.

        Returns
        -------
        ndarray, shape (size, D), or None
            Points of the sampling space. None if the second rig's other parameters have no mode,
            or if its data inform so much about the first rig's parameters that the weights of their
            draws are unreliable.
        """
        first = self._alone.sampling(np.stack([of_first[n] for n in self._alone.names], axis=1))
        centre, count = first.mean(axis=0), first.shape[1]

        def log_density(x: Array, y: Array) -> Array:
            prior_of_first = -0.5 * (LOG_2PI + x**2).sum(axis=1)
            return np.asarray(self.log_posterior(np.hstack([x, y])) - prior_of_first)

        def beside(y: Array, x: Array = centre) -> Array:
            return np.hstack([np.broadcast_to(x, (len(y), count)), y])

        coordinates = self.coordinates(beside(self.start()[None, count:]))[0, :count]
        chart = Chart(
            lambda y: self.coordinates(beside(y))[:, count:],
            lambda own: self.from_coordinates(beside(own, coordinates))[:, count:],
            lambda y: self.coordinates_log_slope(beside(y)),
        )
        try:
            laplace = laplace_approximation(
                lambda y: log_density(beside(y)[:, :count], y),
                self.start()[count:],
                self.scale()[count:],
            )
            refuse_vanished(self, beside(laplace.mode[None])[0])
        except NoModeError:
            return None
        return draws_with_more_data(log_density, first, centre, laplace, seed, chart, size)


def differences(theta: Mapping[str, Array], sizes: tuple[str, ...]) -> dict[str, Array]:
    """Return the relative difference of the second rig's friction for each size."""
    return {size: theta[MEAN] + theta[f"{MEAN}[{size}]"] for size in sizes}

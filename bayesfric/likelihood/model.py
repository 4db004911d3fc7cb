"""Priors and likelihoods put together: one log posterior for a whole ensemble."""

from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bayesfric.priors import Parameter, draw, log_density, prior_sd

__all__ = ["Model", "RigLikelihood"]

Array = NDArray[np.float64]


class RigLikelihood(Protocol):
    """What a rig's likelihood offers to a :class:`Model`."""

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """What it depends on; rigs share a parameter by its name."""

    @property
    def setups(self) -> tuple[str, ...]:
        """Names of its J groups of data: assemblies."""

    @property
    def trials(self) -> pd.DataFrame:
        """Its N trials or runs."""

    def start(self) -> dict[str, float]:
        """Return rough estimates of its parameters."""

    def log_likelihood(self, theta: Mapping[str, Array]) -> Array:
        """Return the log density of its raw data, shape (W,)."""

    def setup_log_likelihood(self, theta: Mapping[str, Array]) -> Array:
        """Return log densities of each group given the rest, shape (W, J)."""

    def trial_log_likelihood(self, theta: Mapping[str, Array]) -> Array:
        """Return log densities of each trial given the rest, shape (W, N)."""


class Model:
    """The posterior of D parameters given the data of one or more rigs.

    Points of the sampling space are vectors `z`: the logarithm of a parameter
    that is positive by its prior, the parameter itself otherwise.

    Parameters
    ----------
    likelihoods : sequence of RigLikelihood
        Independent given the parameters.
    """

    def __init__(self, likelihoods: Sequence[RigLikelihood]) -> None:
        self.likelihoods = tuple(likelihoods)
        named = {p.name: p for rig in self.likelihoods for p in rig.parameters}
        self.parameters = tuple(named.values())
        self._positive = np.array([p.positive for p in self.parameters])

    @property
    def names(self) -> tuple[str, ...]:
        """Parameter names in the order of the vectors."""
        return tuple(p.name for p in self.parameters)

    def natural(self, z: Array) -> Array:
        """Return parameters in their units from sampling-space points, shape (…, D)."""
        return np.where(self._positive, np.exp(np.where(self._positive, z, 0.0)), z)

    def sampling(self, theta: Array) -> Array:
        """Return sampling-space points from parameters in their units, shape (…, D)."""
        return np.where(self._positive, np.log(np.where(self._positive, theta, 1.0)), theta)

    def by_name(self, theta: Array) -> dict[str, Array]:
        """Return the columns of an array of shape (W, D) by parameter name."""
        return dict(zip(self.names, theta.T, strict=True))

    def log_prior(self, theta: Array) -> Array:
        """Return the log prior density in the parameters' units, shape (W,)."""
        columns = zip(self.parameters, theta.T, strict=True)
        terms = np.array([log_density(p.prior, column) for p, column in columns])
        return np.asarray(terms.sum(axis=0))

    def log_likelihood(self, theta: Array) -> Array:
        """Return the log density of the raw data, shape (W,)."""
        named = self.by_name(theta)
        terms = np.array([rig.log_likelihood(named) for rig in self.likelihoods])
        return np.asarray(terms.sum(axis=0))

    def log_posterior(self, z: Array) -> Array:
        """Return the unnormalised log posterior density of `z`.

        Parameters
        ----------
        z : ndarray, shape (W, D)
            Sampling-space points.

        Returns
        -------
        ndarray, shape (W,)
            Log prior, plus the log Jacobian of the sampling space, plus the log
            likelihood; −inf where the prior is zero or the parameters are so
            extreme that the density underflows.
        """
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            theta = self.natural(z)
            prior = self.log_prior(theta) + np.where(self._positive, z, 0.0).sum(axis=1)
            possible = np.isfinite(prior)
            density = np.full(z.shape[0], -np.inf)
            if possible.any():
                density[possible] = prior[possible] + self.log_likelihood(theta[possible])
        return np.where(np.isnan(density), -np.inf, density)

    def start(self) -> Array:
        """Return a sampling-space point to climb from, shape (D,)."""
        estimates: dict[str, float] = {}
        for rig in reversed(self.likelihoods):  # the first rig has the last word
            estimates |= rig.start()
        return self.sampling(np.array([estimates[name] for name in self.names]))

    def scale(self) -> Array:
        """Return the width of each prior in the sampling space, shape (D,)."""
        return np.array([1.0 if p.positive else prior_sd(p.prior) for p in self.parameters])

    def draw_prior(self, size: int, rng: np.random.Generator) -> Array:
        """Return independent prior draws in the parameters' units, shape (size, D)."""
        return np.stack([draw(p.prior, size, rng) for p in self.parameters], axis=1)

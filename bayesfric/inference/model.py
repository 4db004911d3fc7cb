"""Combines priors and likelihoods to one log posterior, evaluated for a whole ensemble at once."""

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple, Protocol

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bayesfric.analysis import Prior
from bayesfric.arrays import Array
from bayesfric.inference.priors import (
    LOG_2PI,
    Parameter,
    draw,
    from_normal,
    joined,
    log_density,
    to_normal,
)

START_RANGE = 6.0  # largest distance of a starting value from the prior's middle [prior sd]
BATCH = 24_000  # trials times walkers whose arrays fit in the processor's cache


class GivenRest(NamedTuple):
    """Predictive densities of each trial and each assembly given all others, W sets of parameters.

    Parameters
    ----------
    trial, setup : ndarray, shape (W, N) and (W, J)
        Log density of each given the rest.
    trial_cdf : ndarray, shape (W, N)
        CDF of each trial's friction at its value, given all others.
    setup_cdf : ndarray, shape (W, J)
        The same for each assembly; NaN if it has none, or if its scatter is not normal.
    more : ndarray, shape (W, N)
        Replicated minus measured friction of each trial given all others [N], in the unit of
        :meth:`RigLikelihood.draw_observed`; shape (W, 0) without replicates.
    """

    trial: Array
    setup: Array
    trial_cdf: Array
    setup_cdf: Array
    more: Array


class RigLikelihood(Protocol):
    """The likelihood of a rig as a :class:`Model` needs it."""

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Parameters of the likelihood; rigs share parameters of the same name."""

    @property
    def setups(self) -> tuple[str, ...]:
        """Names of its J groups of data: assemblies."""

    @property
    def trials(self) -> pd.DataFrame:
        """Its N trials or runs."""

    @property
    def sizes(self) -> tuple[str, ...]:
        """Its pulley sizes."""

    def draw_scatter(
        self, theta: Mapping[str, Array], rng: np.random.Generator, *, together: bool = False
    ) -> Array:
        """Return relative scatter of new trials on new assemblies, shape (W, N)."""

    def draw_observed(
        self, theta: Mapping[str, Array], deviation: Array, rng: np.random.Generator
    ) -> Array:
        """Return friction as measured, given its relative scatter, both of shape (…, W, N)."""

    def start(self) -> dict[str, float]:
        """Return starting values of its parameters."""

    def log_likelihood(self, theta: Mapping[str, Array]) -> Array:
        """Return the log density of its raw data, shape (W,)."""

    def setup_log_likelihood(self, theta: Mapping[str, Array]) -> Array:
        """Return log densities of each group given the rest, shape (W, J)."""

    def given_rest(
        self, theta: Mapping[str, Array], rng: np.random.Generator | None = None
    ) -> GivenRest:
        """Return densities and probabilities of each trial and group given the rest.

        With a generator, a replicate of each trial is drawn too.
        """

    def draw_trial_cdf(self, theta: Mapping[str, Array], rng: np.random.Generator) -> Array:
        """Return CDF values of the trials of replicated recordings.

        One for each set of parameters, shape (W, N).
        """


class Model:
    """The posterior of D parameters given the data of one or more rigs.

    Points of the sampling space are vectors `z` in which every prior is N(0, 1),
    see :func:`bayesfric.inference.priors.from_normal`.

    Parameters
    ----------
    likelihoods : sequence of RigLikelihood
        Likelihoods of the rigs, independent given the parameters.
    more : sequence of Parameter
        Further parameters, which no likelihood lists; they come last.
    """

    def __init__(
        self, likelihoods: Sequence[RigLikelihood], more: Sequence[Parameter] = ()
    ) -> None:
        self.likelihoods = tuple(likelihoods)
        named = {p.name: p for rig in self.likelihoods for p in rig.parameters}
        self.parameters = (*named.values(), *more)
        everywhere = range(len(self.parameters))
        self._priors = self._by_family(everywhere)
        places = {parameter.name: place for place, parameter in enumerate(self.parameters)}
        self._shares = [
            (place, places[parameter.share_of.name])
            for place, parameter in enumerate(self.parameters)
            if parameter.share_of is not None
        ]
        """Indices of parameters with a prior on a share, and of the parameters they refer to."""
        self._straight = [
            (places, prior, np.array([self.parameters[k].power for k in places], dtype=np.float64))
            for places, prior in self._by_family(
                k for k in everywhere if self.parameters[k].power is not None
            )
        ]

    def _by_family(self, places: Iterable[int]) -> list[tuple[NDArray[np.intp], Prior]]:
        """Return indices of the parameters of each family of priors, and their combined prior."""
        there = list(places)
        return [
            (np.array([there[k] for k in members]), prior)
            for members, prior in joined([self.parameters[k].prior for k in there])
        ]

    @property
    def names(self) -> tuple[str, ...]:
        """Parameter names in the order of the vectors."""
        return tuple(p.name for p in self.parameters)

    def natural(self, z: Array) -> Array:
        """Return parameters in their units from sampling-space points, shape (…, D)."""
        theta = np.empty_like(z)
        for places, prior in self._priors:
            theta[..., places] = from_normal(prior, z[..., places])
        for part, whole in self._shares:
            theta[..., part] *= theta[..., whole]
        return theta

    def sampling(self, theta: Array) -> Array:
        """Return sampling-space points from parameters in their units, shape (…, D)."""
        z = np.empty_like(theta)
        shares = self._as_shares(theta)
        for places, prior in self._priors:
            z[..., places] = to_normal(prior, shares[..., places])
        return z

    def _as_shares(self, theta: Array) -> Array:
        """Return the quantities to which the priors apply (parameters or shares), shape (…, D)."""
        if not self._shares:
            return theta
        values = theta.copy()
        for part, whole in self._shares:
            values[..., part] /= theta[..., whole]
        return values

    def coordinates(self, z: Array) -> Array:
        """Return coordinates in which the posterior is closer to normal, shape (W, D).

        Parameters with a :attr:`Parameter.power` are raised to it; others stay on the sampling
        scale.
        """
        x = z.copy()
        for places, prior, power in self._straight:
            x[:, places] = from_normal(prior, z[:, places]) ** power
        for part, whole in self._shares:
            x[:, part] *= self._natural_at(whole, z)
        return x

    def _natural_at(self, place: int, z: Array) -> Array:
        """Return one parameter in its unit, shape (W,); its own prior must not be on a share."""
        return np.asarray(from_normal(self.parameters[place].prior, z[:, place]))

    def from_coordinates(self, x: Array) -> Array:
        """Return the points of :meth:`coordinates`; NaN if there is no such point."""
        z = x.copy()
        with np.errstate(all="ignore"):  # powers of negative numbers, and shares of 0, are NaN
            values = x.copy()
            for part, whole in self._shares:
                values[:, part] /= x[:, whole]  # of power 1: it is its own coordinate
            for places, prior, power in self._straight:
                value = values[:, places]
                z[:, places] = to_normal(prior, value ** (1 / power))
                z[:, places] = np.where((power == 1) | (value > 0), z[:, places], np.nan)
        return z

    def coordinates_log_slope(self, z: Array) -> Array:
        """Return the log determinant of the derivative of :meth:`coordinates`, shape (W,)."""
        slope = np.zeros(len(z))
        for places, prior, power in self._straight:
            value = from_normal(prior, z[:, places])
            # The probability is the same in both coordinates: N(z) dz = p(x) dx.
            normal = -0.5 * (LOG_2PI + z[:, places] ** 2)
            slope += (normal - log_density(prior, value)).sum(axis=1)
            curved = power != 1
            # Far in the tail of its prior, a positive parameter underflows to 0.
            positive = np.maximum(value[:, curved], np.finfo(np.float64).tiny)
            raised = np.log(positive) * (power[curved] - 1) + np.log(power[curved])
            slope += raised.sum(axis=1)
        for _, whole in self._shares:
            slope += np.log(np.maximum(self._natural_at(whole, z), np.finfo(np.float64).tiny))
        return slope

    def by_name(self, theta: Array) -> dict[str, Array]:
        """Return the columns of an array of shape (W, D) by parameter name."""
        return dict(zip(self.names, theta.T, strict=True))

    def log_prior(self, theta: Array) -> Array:
        """Return the log prior density in the parameters' units, shape (W,)."""
        return np.asarray(self.log_priors(theta).sum(axis=-1))

    def log_priors(self, theta: Array) -> Array:
        """Return the log prior density of each parameter, shape (…, D).

        The prior of a parameter with `share_of` is conditional on the parameter that this names.
        """
        shares = self._as_shares(theta)
        density = np.empty_like(theta)
        for places, prior in self._priors:
            density[..., places] = log_density(prior, shares[..., places])
        for part, whole in self._shares:
            density[..., part] -= np.log(theta[..., whole])
        return density

    def log_likelihood(self, theta: Array) -> Array:
        """Return the log density of the raw data, shape (W,)."""
        trials = sum(len(rig.trials) for rig in self.likelihoods)
        batch = max(1, BATCH // max(1, trials))
        parts = [theta[start : start + batch] for start in range(0, len(theta), batch)]
        return np.concatenate([self._log_likelihood(part) for part in parts])

    def _log_likelihood(self, theta: Array) -> Array:
        """Return the log density of the raw data for one batch of walkers, (W,)."""
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
            Log prior of `z`, which is N(0, 1), plus the log likelihood; −inf where the
            parameters are so extreme that the density underflows.
        """
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            theta = self.natural(z)
            prior = -0.5 * (LOG_2PI + z**2).sum(axis=1)
            possible = np.isfinite(theta).all(axis=1)
            density = np.full(z.shape[0], -np.inf)
            if possible.any():
                density[possible] = prior[possible] + self.log_likelihood(theta[possible])
        return np.where(np.isnan(density), -np.inf, density)

    def start(self) -> Array:
        """Return a starting point in the sampling space, shape (D,)."""
        estimates: dict[str, float] = {}
        for rig in reversed(self.likelihoods):  # the first rig's values replace those of later rigs
            estimates |= rig.start()
        z = self.sampling(np.array([estimates[name] for name in self.names]))
        return np.clip(z, -START_RANGE, START_RANGE)

    def scale(self) -> Array:
        """Return the width of each prior in the sampling space, shape (D,)."""
        return np.ones(len(self.parameters))

    def draw_prior(self, size: int, rng: np.random.Generator) -> Array:
        """Return independent prior draws in the parameters' units, shape (size, D)."""
        theta = np.stack([draw(p.prior, size, rng) for p in self.parameters], axis=1)
        for part, whole in self._shares:
            theta[:, part] *= theta[:, whole]
        return theta

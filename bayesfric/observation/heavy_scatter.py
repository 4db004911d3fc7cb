"""Student-t deviations of friction in a linear model: normal deviations, each with a weight.

A deviation of R components is normal with variances divided by λ, and λ ~ Γ(ν/2, ν/2). Together
this is a Student-t. Given the weights λ a linear model is normal. log λ is set to the mode of its
density, where λ = (ν + R) / (ν + E z²) with z the components over their scales. The integral over
λ is approximated by that of a gamma density with the same curvature at this mode. This is exact if
the data determine a deviation exactly, and if they do not inform it.

References
----------
K. L. Lange, R. J. A. Little, J. M. G. Taylor, "Robust statistical modeling using the t
distribution", JASA 84 (1989).
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.special import gammaln

from bayesfric.arrays import Array, Flags, Whole

LEAST_SHAPE = 0.25  # least shape of the gamma density, relative to ν/2


class Deviations(NamedTuple):
    """Posterior of M deviations of R components, in units of their standard deviations.

    Parameters
    ----------
    mean : ndarray, shape (M, R)
    covariance : ndarray, shape (M, R, R)
    """

    mean: Array
    covariance: Array


@dataclass(frozen=True)
class HeavyScatter:
    """The weights of deviations, of trials or of assemblies.

    Parameters
    ----------
    level : str
        ``trial`` or ``assembly``.
    freedom : float
        ν.
    rank : int
        R.
    weight : ndarray, shape (M,)
        Weights λ.
    volume : ndarray, shape (M,)
        Log of the integral over log λ divided by the density at the mode, minus that of a deviation
        that is known exactly.
    """

    level: str
    freedom: float
    rank: int
    weight: Array
    volume: Array

    @classmethod
    def equal(cls, level: str, freedom: float, rank: int, count: int) -> "HeavyScatter":
        """Return equal weights as a starting value."""
        return cls(level, freedom, rank, np.ones(count), np.zeros(count))

    def updated(self, given: Deviations) -> "HeavyScatter":
        """Return the weights at the mode, given the posterior of the deviations.

        Parameters
        ----------
        given : Deviations
            Posterior at the present weights, in units of the scales with these weights.
        """
        half = self.freedom / 2
        mean, covariance = given
        square = (mean**2).sum(axis=1) + np.einsum("mrr->m", covariance)
        bent = np.einsum("mr,mrs,ms->m", mean, covariance, mean)
        bent += 0.5 * np.einsum("mrs,mrs->m", covariance, covariance)
        shape = np.maximum(half * self.weight + 0.5 * square - bent, LEAST_SHAPE * half)
        weight = (self.freedom + self.rank) / (self.freedom + square / self.weight)
        volume = _log_volume(shape) - _log_volume(half + 0.5 * self.rank)
        return replace(self, weight=weight, volume=volume)

    def log_density(self, setup: Whole, used: Flags | None = None) -> float:
        """Return the log prior density of the logarithms of the weights, and its volume.

        Parameters
        ----------
        setup : ndarray of int, shape (N,)
            Assembly of each trial.
        used : ndarray of bool, shape (N,), or None
            Trials that are used; None is all.
        """
        half, log = self.freedom / 2, np.log(self.weight)
        density = half * np.log(half) - gammaln(half) + half * (log - self.weight)
        density = density + _log_volume(half + 0.5 * self.rank)
        if used is not None:
            density = density[used if self.level == "trial" else np.unique(setup[used])]
        return float(density.sum())

    def of_trials(self, trials: Whole) -> Array | float:
        """Return the divisors of the variances of trials' own deviations."""
        return self.weight[trials] if self.level == "trial" else 1.0

    def of_setups(self, setups: Whole) -> Array | float:
        """Return the divisors of the variances of assemblies' deviations."""
        return self.weight[setups] if self.level == "assembly" else 1.0


def _log_volume(shape: Array | float) -> Array:
    """Return the log integral of exp(h (u − eᵘ + 1)) over u for a shape h."""
    return np.asarray(gammaln(shape) - shape * np.log(shape) + shape)

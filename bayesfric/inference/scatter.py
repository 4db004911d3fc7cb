"""Friction that scatters from trial to trial and from assembly to assembly.

The friction of trial j on assembly i is ``μ_ij (1 + η_i + ε_ij)`` with
``η ~ N(0, ω²)`` and ``ε ~ N(0, τ²)``, and it is observed with a Gaussian error of
known variance. Given μ, τ and ω, an assembly is one multivariate normal whose
covariance is diagonal plus the outer product ``ω² μ μᵀ``; its determinant and its
inverse are closed forms (matrix determinant lemma, Sherman–Morrison).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

__all__ = ["SetupIndex", "setup_log_density", "trial_cdf", "trial_log_density"]

Array = NDArray[np.float64]
LOG_2PI = float(np.log(2 * np.pi))


@dataclass(frozen=True)
class SetupIndex:
    """Which trials belong to which assembly; trials of one assembly are adjacent.

    Parameters
    ----------
    starts : ndarray of int, shape (J,)
        Index of the first trial of each assembly, ascending, the first being 0.
    trials : int
        Number of trials N.
    """

    starts: NDArray[np.intp]
    trials: int

    @property
    def of_trial(self) -> NDArray[np.intp]:
        """The assembly of each trial, shape (N,)."""
        marks = np.zeros(self.trials, dtype=np.intp)
        marks[self.starts[1:]] = 1
        return np.cumsum(marks)

    def total(self, values: Array) -> Array:
        """Sum the last axis (N) over each assembly (J)."""
        return np.add.reduceat(values, self.starts, axis=-1)


@dataclass(frozen=True)
class _Gaussian:
    """What both densities need: residual r, diagonal d, and sums over an assembly."""

    r: Array
    mu: Array
    d: Array
    omega2: Array  # (…, J)
    s1: Array  # Σ μ²/d
    s2: Array  # Σ μ r/d


def _gaussian(
    index: SetupIndex, observed: Array, variance: Array, mu: Array, tau: Array, omega: Array
) -> _Gaussian:
    d = (mu * tau) ** 2 + variance
    r = observed - mu
    weighted = mu / d
    return _Gaussian(
        r,
        mu,
        d,
        omega[..., index.starts] ** 2,
        index.total(weighted * mu),
        index.total(weighted * r),
    )


def setup_log_density(
    index: SetupIndex, observed: Array, variance: Array, mu: Array, tau: Array, omega: Array
) -> Array:
    """Return the log density of each assembly's observed friction.

    Parameters
    ----------
    index : SetupIndex
        N trials in J assemblies.
    observed, variance : ndarray, shape (…, N)
        Observed friction [N] and the variance of its measurement error [N²].
    mu : ndarray, shape (…, N)
        Friction of the law [N].
    tau, omega : ndarray, broadcastable to (…, N)
        Relative scatter of a trial and of an assembly.

    Returns
    -------
    ndarray, shape (…, J)
        Joint log density of the trials of each assembly.
    """
    omega = np.broadcast_to(omega, mu.shape)
    g = _gaussian(index, observed, variance, mu, tau, omega)
    gain = 1 + g.omega2 * g.s1
    diagonal = index.total(LOG_2PI + np.log(g.d) + g.r**2 / g.d)
    return -0.5 * (diagonal + np.log(gain) - g.omega2 * g.s2**2 / gain)


def trial_log_density(
    index: SetupIndex, observed: Array, variance: Array, mu: Array, tau: Array, omega: Array
) -> Array:
    """Return the log density of each trial given the other trials of its assembly.

    The arguments are those of :func:`setup_log_density`.

    Returns
    -------
    ndarray, shape (…, N)
        ``log p(y_j | y_−j)``, the leave-one-out density of a multivariate normal.

    References
    ----------
    P.-C. Bürkner, J. Gabry, A. Vehtari, "Efficient leave-one-out cross-validation
    for Bayesian non-factorized normal and Student-t models", Computational
    Statistics 36 (2021).
    """
    score, precision = _given_the_rest(index, observed, variance, mu, tau, omega)
    return 0.5 * (np.log(precision) - LOG_2PI - score**2 / precision)


def trial_cdf(
    index: SetupIndex, observed: Array, variance: Array, mu: Array, tau: Array, omega: Array
) -> Array:
    """Return the probability of a lower friction of each trial given its assembly's others.

    The arguments are those of :func:`setup_log_density`.

    Returns
    -------
    ndarray, shape (…, N)
        ``P(Y_j ≤ y_j | y_−j)``.
    """
    score, precision = _given_the_rest(index, observed, variance, mu, tau, omega)
    return np.asarray(ndtr(score / np.sqrt(precision)))


def _given_the_rest(
    index: SetupIndex, observed: Array, variance: Array, mu: Array, tau: Array, omega: Array
) -> tuple[Array, Array]:
    """Return Σ⁻¹r and the diagonal of Σ⁻¹: precision times residual given the rest, and it."""
    omega = np.broadcast_to(omega, mu.shape)
    g = _gaussian(index, observed, variance, mu, tau, omega)
    shrink = (g.omega2 / (1 + g.omega2 * g.s1))[..., index.of_trial]
    weighted = g.mu / g.d
    precision = 1 / g.d - shrink * weighted**2
    score = g.r / g.d - shrink * weighted * g.s2[..., index.of_trial]
    return score, precision

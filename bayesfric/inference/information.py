"""The information matrix of a linear Gaussian model, and the evidence that follows from it.

Given the noise, the log likelihood of the model's coefficients g is a quadratic form: an
information matrix (``precision``), a vector (``slope``) and a constant. Each coefficient has an
independent normal prior.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, cho_factor, cho_solve, eigh
from scipy.linalg.lapack import dpotri

from bayesfric.arrays import Array, Whole

ROUNDED = 1e-12  # rounding error of the least eigenvalue, relative to the largest one


@dataclass(frozen=True)
class Reduced:
    """The likelihood of candidates' amplitudes A, with all other coefficients integrated out.

    ``log p(data | A) = log_evidence + slopeᵀA − Aᵀ precision A / 2``.

    Parameters
    ----------
    precision : ndarray, shape (E, E)
        Information matrix of the data, without the candidates' priors.
    slope : ndarray, shape (E,)
        Gradient at A = 0.
    log_evidence : float
        Log evidence without any candidate.
    """

    precision: Array
    slope: Array
    log_evidence: float


@dataclass(frozen=True)
class Information:
    """``log p(data | g) = constant + slopeᵀg − gᵀ precision g / 2``.

    Parameters
    ----------
    precision : ndarray, shape (p, p)
        Information matrix of the coefficients g.
    slope : ndarray, shape (p,)
        Gradient at g = 0.
    constant : float
        Log density at g = 0.
    """

    precision: Array
    slope: Array
    constant: float

    def __add__(self, other: "Information") -> "Information":
        """Return the joint information of two independent data sets."""
        return Information(
            self.precision + other.precision,
            self.slope + other.slope,
            self.constant + other.constant,
        )

    def at(self, numbers: Whole) -> "Information":
        """Return the information on some coefficients, with all others fixed at 0."""
        chosen = self.precision[np.ix_(numbers, numbers)]
        return Information(chosen, self.slope[numbers], self.constant)

    def mixed(self, numbers: Whole, mixing: Array) -> "Information":
        """Return the information with adjacent coefficients restricted to k combinations of them.

        Parameters
        ----------
        numbers : ndarray of int, shape (n,)
            Indices of the adjacent coefficients.
        mixing : ndarray, shape (n, k)
            One combination in each column; its amplitude is a new coefficient.
        """
        start = int(numbers[0]) if numbers.size else 0
        stop = start + numbers.size

        def of(values: Array) -> Array:
            parts = [values[..., :start], values[..., start:stop] @ mixing, values[..., stop:]]
            return np.concatenate(parts, axis=-1)

        return Information(of(of(self.precision).T), of(self.slope), self.constant)

    def reduced(self, mean: Array, prior_sd: Array, candidates: NDArray[np.intp]) -> Reduced:
        """Integrate out all coefficients except those of the candidates.

        Parameters
        ----------
        mean, prior_sd : ndarray, shape (p,)
            Mean and standard deviation of each coefficient's prior; those of the candidates are
            not used. A standard deviation of 0 fixes a coefficient at its mean.
        candidates : ndarray of int
            Indices of the candidates' coefficients.
        """
        rest = np.delete(np.arange(self.slope.size), candidates)
        scale, at = prior_sd[rest], mean[rest]
        inner = self.precision[np.ix_(rest, rest)]
        whole = scale[:, None] * inner * scale + np.eye(rest.size)
        slope = scale * (self.slope[rest] - inner @ at)
        across = self.precision[np.ix_(candidates, rest)]
        factor = _factor(whole)
        solved = cho_solve(factor, np.column_stack([slope, (across * scale).T]))
        log_determinant = 2 * np.log(np.diag(factor[0])).sum()
        at_mean = self.constant + self.slope[rest] @ at - 0.5 * at @ inner @ at
        evidence = at_mean + 0.5 * slope @ solved[:, 0] - 0.5 * log_determinant
        return Reduced(
            self.precision[np.ix_(candidates, candidates)] - (across * scale) @ solved[:, 1:],
            self.slope[candidates] - across @ at - (across * scale) @ solved[:, 0],
            float(evidence),
        )

    def integrated(self, mean: Array, prior_sd: Array) -> tuple[float, Array, Array]:
        """Return the log evidence, and the posterior mean and covariance of all coefficients."""
        whole = prior_sd[:, None] * self.precision * prior_sd + np.eye(self.slope.size)
        factor = _factor(whole)
        left = self.precision @ mean
        slope = prior_sd * (self.slope - left)
        moved = cho_solve(factor, slope)
        value = self.constant + self.slope @ mean - 0.5 * mean @ left + 0.5 * slope @ moved
        value -= np.log(np.diag(factor[0])).sum()
        inverse, status = dpotri(factor[0], lower=1)
        assert status == 0
        inverse = np.tril(inverse) + np.tril(inverse, -1).T
        return float(value), mean + prior_sd * moved, prior_sd[:, None] * inverse * prior_sd

    def posterior(self, mean: Array, prior_sd: Array) -> tuple[Array, Array]:
        """Return the posterior mean, shape (p,), and covariance, shape (p, p)."""
        whole = prior_sd[:, None] * self.precision * prior_sd + np.eye(self.slope.size)
        factor = _factor(whole)
        slope = prior_sd * (self.slope - self.precision @ mean)
        covariance = prior_sd[:, None] * cho_solve(factor, np.eye(self.slope.size)) * prior_sd
        return mean + prior_sd * cho_solve(factor, slope), covariance


def _factor(whole: Array) -> tuple[Array, bool]:
    """Return the Cholesky factor of a precision that includes a unit prior, and a flag.

    Without rounding no eigenvalue is below 1. At extreme noise parameters, numbers of 10¹⁴ nearly
    cancel, and rounding can leave eigenvalues below 1. They are set to 1 or, if the rounding error
    of the largest eigenvalue exceeds 1, to that error.
    """
    try:
        return cho_factor(whole, lower=True)
    except LinAlgError:
        values, vectors = eigh(whole)
    for least in (1.0, max(1.0, ROUNDED * float(values[-1]))):
        try:
            return cho_factor((vectors * np.maximum(values, least)) @ vectors.T, lower=True)
        except LinAlgError:
            continue
    raise LinAlgError("an information matrix that is no sum of squares")

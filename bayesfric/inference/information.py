"""The information matrix of a linear Gaussian model, and the evidence that follows.

Given the noise, the log likelihood of the model's numbers g is a quadratic form: an
information matrix (``precision``), a vector (``slope``) and a constant. Each number has an
independent normal prior.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, cho_factor, cho_solve, eigh
from scipy.linalg.lapack import dpotri

from bayesfric.arrays import Array, Whole

ROUNDED = 1e-12  # relative to the largest eigenvalue: rounding error of the least one


@dataclass(frozen=True)
class Reduced:
    """A quadratic form in the amplitudes of candidates, all else integrated out.

    Parameters
    ----------
    precision : ndarray, shape (E, E)
        Of the data alone, without the candidates' priors.
    slope : ndarray, shape (E,)
        So that ``log p(data | A) = log_evidence + slopeᵀA − Aᵀ precision A / 2``.
    log_evidence : float
        Without any candidate.
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
        Of the numbers g.
    slope : ndarray, shape (p,)
        As above.
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
        """Return the information on some numbers, with all others fixed at 0."""
        chosen = self.precision[np.ix_(numbers, numbers)]
        return Information(chosen, self.slope[numbers], self.constant)

    def mixed(self, numbers: Whole, mixing: Array) -> "Information":
        """Return the information with adjacent numbers replaced by coefficients of combinations.

        Parameters
        ----------
        numbers : ndarray of int, shape (n,)
            Positions of the adjacent numbers.
        mixing : ndarray, shape (n, k)
            One combination in each column.
        """
        start = int(numbers[0]) if numbers.size else 0
        stop = start + numbers.size

        def of(values: Array) -> Array:
            parts = [values[..., :start], values[..., start:stop] @ mixing, values[..., stop:]]
            return np.concatenate(parts, axis=-1)

        return Information(of(of(self.precision).T), of(self.slope), self.constant)

    def reduced(self, mean: Array, prior_sd: Array, candidates: NDArray[np.intp]) -> Reduced:
        """Integrate out all numbers but the candidates.

        Parameters
        ----------
        mean, prior_sd : ndarray, shape (p,)
            Of each number's prior; those of the candidates are not used. A
            standard deviation of 0 holds a number at its mean.
        candidates : ndarray of int
            Places of the candidates.
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
        """Return the log evidence, and the posterior mean and covariance of all numbers."""
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
        """Return mean, shape (p,), and covariance, shape (p, p), of all numbers."""
        whole = prior_sd[:, None] * self.precision * prior_sd + np.eye(self.slope.size)
        factor = _factor(whole)
        slope = prior_sd * (self.slope - self.precision @ mean)
        covariance = prior_sd[:, None] * cho_solve(factor, np.eye(self.slope.size)) * prior_sd
        return mean + prior_sd * cho_solve(factor, slope), covariance


def _factor(whole: Array) -> tuple[Array, bool]:
    """Return the Cholesky factor of a precision that includes a unit prior, and a flag.

    No exact eigenvalue is below 1. At extreme noise parameters nearly all of 10¹⁴ cancels, and
    rounding can leave eigenvalues below 1. They are set to 1 or, if the largest eigenvalue is
    so large that this is below its rounding error, to that error.
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

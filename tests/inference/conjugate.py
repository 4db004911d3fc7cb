"""The linear model with normal errors and a normal prior, in closed form.

y = X b + e with b ~ N(0, diag(s²)) and e ~ N(0, Σ): then y ~ N(0, Σ + X diag(s²) Xᵀ).

References
----------
A. Gelman et al., "Bayesian Data Analysis", 3rd ed. (2013), chapter 14.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve, cholesky

__all__ = ["LinearGaussian"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LinearGaussian:
    """A linear model of N measurements with K coefficients.

    Parameters
    ----------
    design : ndarray, shape (N, K)
        X.
    prior_sd : ndarray, shape (K,)
        s, above zero.
    noise : ndarray, shape (N, N)
        Σ, positive definite.

    Raises
    ------
    ValueError
        The shapes do not fit.
    """

    design: Array
    prior_sd: Array
    noise: Array

    def __post_init__(self) -> None:
        size, coefficients = self.design.shape
        if self.noise.shape != (size, size) or self.prior_sd.shape != (coefficients,):
            raise ValueError(
                f"design {self.design.shape}, prior_sd {self.prior_sd.shape} and noise "
                f"{self.noise.shape} do not fit together"
            )

    @cached_property
    def covariance(self) -> Array:
        """Covariance of the measurements, shape (N, N)."""
        scaled = self.design * self.prior_sd
        return self.noise + scaled @ scaled.T

    def log_evidence(self, measured: Array) -> float:
        """Return the log density of measurements of shape (N,) [nat]."""
        return _log_normal(measured, self.covariance)

    def log_conditional(self, measured: Array, group: NDArray[np.bool_]) -> float:
        """Return the log density of a group of the measurements given the others.

        Parameters
        ----------
        measured : ndarray, shape (N,)
            All measurements.
        group : ndarray of bool, shape (N,)
            Which belong to the group.

        Returns
        -------
        float
            [nat]
        """
        others = ~group
        rest = _log_normal(measured[others], self.covariance[np.ix_(others, others)])
        return self.log_evidence(measured) - rest

    def posterior(self, measured: Array) -> tuple[Array, Array]:
        """Return mean and covariance of the coefficients, shapes (K,) and (K, K)."""
        across = self.design * self.prior_sd**2  # covariance of measurements and coefficients
        root = cholesky(self.covariance, lower=True)
        mean = across.T @ cho_solve((root, True), measured)
        return mean, np.diag(self.prior_sd**2) - across.T @ cho_solve((root, True), across)


def _log_normal(values: Array, covariance: Array) -> float:
    root = cholesky(covariance, lower=True)
    square = values @ cho_solve((root, True), values)
    log_determinant = 2 * np.log(np.diag(root)).sum()
    return float(-0.5 * (values.size * np.log(2 * np.pi) + log_determinant + square))

"""A smooth process of zero mean along an interval, as a few cosines.

Its correlation is the Matérn form of order 3/2: the spectral density at the wavenumber ω is
in proportion to (1 + (ω ℓ)² / 3)⁻², ℓ being the correlation length. Along an interval of
extent X the cosines of wavenumber k π / X, k ≥ 1, have independent coefficients, their
variances in proportion to the density there; the constant, k = 0, is left out.

References
----------
A. Solin, S. Särkkä, "Hilbert space methods for reduced-rank Gaussian process regression",
Statistics and Computing 30 (2020).
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["MODES", "WHOLE", "cosine_variances", "cosines"]

Array = NDArray[np.float64]
MODES = 6  # whose double integral stands out of the noise of events where the rms is 2 %
WHOLE = 64  # cosines that make up the process, and its rms


def cosines(place: ArrayLike, count: int) -> Array:
    """Return the cosines at places of the interval.

    Parameters
    ----------
    place : array_like
        From 0 to 1.
    count : int
        How many.

    Returns
    -------
    ndarray, shape (count, …)
        √2 cos(k π place), of rms 1, for k = 1, 2, ….
    """
    order = np.arange(1, count + 1).reshape(-1, *(1,) * np.ndim(place))
    return np.asarray(np.sqrt(2) * np.cos(np.pi * order * np.asarray(place)))


def cosine_variances(length: ArrayLike, count: int) -> Array:
    """Return the variances of the coefficients of a process of rms 1.

    Parameters
    ----------
    length : array_like
        Correlation length over the interval's extent.
    count : int
        How many, at most :data:`WHOLE`.

    Returns
    -------
    ndarray, shape (count, …)
        Of the first cosines; they add up to 1 over all :data:`WHOLE`.
    """
    order = np.arange(1, WHOLE + 1).reshape(-1, *(1,) * np.ndim(length))
    density = (1 + (np.pi * order * np.asarray(length)) ** 2 / 3) ** -2
    return np.asarray(density[:count] / density.sum(axis=0))

"""A smooth process of zero mean along an interval: a sum of a few cosines.

Along an interval of extent X the cosines of wavenumber k π / X, k ≥ 1, have independent normal
coefficients. Their variances are in proportion to the spectral density of the Matérn form of
order 3/2, (1 + (ω ℓ)² / 3)⁻², at their wavenumbers ω, and add up to the square of the process'
rms; ℓ is the correlation length. The constant, k = 0, is left out. The sum *is* the process:
what is simulated is what a likelihood follows.

References
----------
A. Solin, S. Särkkä, "Hilbert space methods for reduced-rank Gaussian process regression",
Statistics and Computing 30 (2020).
"""

import numpy as np
from numpy.typing import ArrayLike

from bayesfric.arrays import Array

MODES = 6  # more would be lost in the noise of events at an rms of 2 %


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
        How many cosines make the process.

    Returns
    -------
    ndarray, shape (count, …)
        They add up to 1.
    """
    order = np.arange(1, count + 1).reshape(-1, *(1,) * np.ndim(length))
    density = (1 + (np.pi * order * np.asarray(length)) ** 2 / 3) ** -2
    return np.asarray(density / density.sum(axis=0))


def log_variance_slopes(length: float, count: int) -> Array:
    """Return how the logarithms of :func:`cosine_variances` grow with that of the length.

    Parameters
    ----------
    length : float
        Correlation length over the interval's extent.
    count : int
        How many cosines make the process.

    Returns
    -------
    ndarray, shape (count,)
        d log variance / d log length.
    """
    turned = (np.pi * np.arange(1, count + 1) * length) ** 2 / 3
    slope = -4 * turned / (1 + turned)
    return np.asarray(slope - cosine_variances(length, count) @ slope)

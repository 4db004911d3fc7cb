"""A smooth zero-mean process along an interval: a sum of a few cosines.

Along an interval of extent X, the cosines with wavenumbers ω = k π / X, k ≥ 1, have independent
normal coefficients. Their variances are proportional to the spectral density of the Matérn kernel
of order 3/2, (1 + (ω ℓ)² / 3)⁻², with ℓ the correlation length, and sum to the mean square of the
process. There is no constant term (k = 0). Simulators and likelihoods use the same finite sum, so
it is no approximation.

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
    """Return the cosines at some positions in the interval.

    Parameters
    ----------
    place : array_like
        Positions, from 0 to 1.
    count : int
        Number of cosines.

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
        Correlation length, relative to the interval's extent.
    count : int
        Number of cosines.

    Returns
    -------
    ndarray, shape (count, …)
        Variances, which sum to 1.
    """
    order = np.arange(1, count + 1).reshape(-1, *(1,) * np.ndim(length))
    density = (1 + (np.pi * order * np.asarray(length)) ** 2 / 3) ** -2
    return np.asarray(density / density.sum(axis=0))


def log_variance_slopes(length: float, count: int) -> Array:
    """Return derivatives of log :func:`cosine_variances` by the logarithm of the length.

    Parameters
    ----------
    length : float
        Correlation length, relative to the interval's extent.
    count : int
        Number of cosines.

    Returns
    -------
    ndarray, shape (count,)
        d log variance / d log length.
    """
    turned = (np.pi * np.arange(1, count + 1) * length) ** 2 / 3
    slope = -4 * turned / (1 + turned)
    return np.asarray(slope - cosine_variances(length, count) @ slope)

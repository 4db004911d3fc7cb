"""Eigenvalues of a symmetric matrix, whatever LAPACK's quickest way makes of it."""

import numpy as np
from scipy.linalg import eigh

from bayesfric.arrays import Array


def eigen_of(matrix: Array) -> tuple[Array, Array]:
    """Return eigenvalues, ascending, and eigenvectors of a symmetric matrix.

    The divide-and-conquer method of LAPACK, which NumPy has, is the quickest and fails now and
    then on finite matrices of some hundred rows; the QR method behind it does not.

    Parameters
    ----------
    matrix : ndarray, shape (n, n)
        Symmetric and finite.

    Returns
    -------
    values : ndarray, shape (n,)
    vectors : ndarray, shape (n, n)

    Raises
    ------
    numpy.linalg.LinAlgError
        It is not finite.
    """
    if not np.isfinite(matrix).all():
        raise np.linalg.LinAlgError("a matrix whose eigenvalues are asked for is not finite")
    try:
        values, vectors = np.linalg.eigh(matrix)
    except np.linalg.LinAlgError:
        values, vectors = eigh(matrix, driver="ev")
    return np.asarray(values, dtype=np.float64), np.asarray(vectors, dtype=np.float64)


def root_of(covariance: Array) -> Array:
    """Return a matrix, (n, n), whose product with its transpose is a covariance.

    Eigenvalues that rounding has left below zero count as zero.

    Parameters
    ----------
    covariance : ndarray, shape (n, n)
        Symmetric and finite, with no negative eigenvalue but for rounding.
    """
    values, vectors = eigen_of(covariance)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)))

"""Eigenvalues of a symmetric matrix, whatever LAPACK's quickest way makes of it; inverses."""

import numpy as np
from scipy.linalg import eigh
from scipy.linalg.lapack import dgetrf, dgetri

from bayesfric.arrays import Array

LARGE = 20  # rows of a matrix, from which on a factor costs more than a call


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


def inverted(matrices: Array) -> tuple[Array, Array]:
    """Return inverses of symmetric matrices, and the logarithms of their determinants' sizes.

    Both are from one factorisation.

    Parameters
    ----------
    matrices : ndarray, shape (…, n, n)
        Finite; they may have eigenvalues below zero.

    Returns
    -------
    inverse : ndarray, shape (…, n, n)
    log_determinant : ndarray, shape (…)

    Raises
    ------
    numpy.linalg.LinAlgError
        One is singular.
    """
    if matrices.shape[-1] < LARGE:
        inverse = np.asarray(np.linalg.inv(matrices), dtype=np.float64)
        return inverse, np.asarray(np.linalg.slogdet(matrices)[1], dtype=np.float64)
    inverses, pivots = np.empty_like(matrices), np.empty(matrices.shape[:-1])
    for place in np.ndindex(matrices.shape[:-2]):
        factor, order, _ = dgetrf(matrices[place].T)  # in LAPACK's order, without a copy more
        pivots[place] = np.diagonal(factor)
        inverse, singular = dgetri(factor, order, overwrite_lu=True)
        if singular:
            raise np.linalg.LinAlgError("a singular matrix that is to be inverted")
        inverses[place] = inverse.T
    return inverses, np.asarray(np.log(np.abs(pivots)).sum(axis=-1))

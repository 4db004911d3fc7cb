"""Eigenvalues, roots and inverses of symmetric matrices."""

import numpy as np
from scipy.linalg import eigh
from scipy.linalg.lapack import dgetrf, dgetri

from bayesfric.arrays import Array

LARGE = 20  # rows from which one factorisation of a matrix is cheaper than two calls of NumPy


def eigen_of(matrix: Array) -> tuple[Array, Array]:
    """Return eigenvalues, ascending, and eigenvectors of a symmetric matrix.

    NumPy uses LAPACK's divide-and-conquer method, which is fast but sometimes fails for finite
    matrices of some hundred rows. The slower QR method is then used.

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
        If the matrix is not finite.
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

    Eigenvalues that are negative by rounding errors are replaced by 0.

    Parameters
    ----------
    covariance : ndarray, shape (n, n)
        Symmetric, finite and positive semidefinite, except for rounding errors.
    """
    values, vectors = eigen_of(covariance)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)))


def inverted(matrices: Array) -> tuple[Array, Array]:
    """Return inverses of symmetric matrices, and logarithms of their absolute determinants.

    For large matrices both come from one factorisation.

    Parameters
    ----------
    matrices : ndarray, shape (…, n, n)
        Finite; negative eigenvalues are allowed.

    Returns
    -------
    inverse : ndarray, shape (…, n, n)
    log_determinant : ndarray, shape (…)
        log |det|.

    Raises
    ------
    numpy.linalg.LinAlgError
        If a matrix is singular.
    """
    if matrices.shape[-1] < LARGE:
        inverse = np.asarray(np.linalg.inv(matrices), dtype=np.float64)
        return inverse, np.asarray(np.linalg.slogdet(matrices)[1], dtype=np.float64)
    inverses, pivots = np.empty_like(matrices), np.empty(matrices.shape[:-1])
    for place in np.ndindex(matrices.shape[:-2]):
        factor, order, _ = dgetrf(matrices[place].T)  # the transpose is in LAPACK's memory order
        pivots[place] = np.diagonal(factor)
        inverse, singular = dgetri(factor, order, overwrite_lu=True)
        if singular:
            raise np.linalg.LinAlgError("a singular matrix that is to be inverted")
        inverses[place] = inverse.T
    return inverses, np.asarray(np.log(np.abs(pivots)).sum(axis=-1))

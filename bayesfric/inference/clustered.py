"""Errors of least squares with residuals that are correlated within groups of rows."""

import numpy as np

from bayesfric.arrays import Array, Whole


def summed_by_group(values: Array, groups: Whole) -> Array:
    """Return the sums of rows, one row for each group.

    Parameters
    ----------
    values : ndarray, shape (W, k)
        A value of each column in each row.
    groups : ndarray of int, shape (W,)
        Group of each row, from 0 to G − 1.

    Returns
    -------
    ndarray, shape (G, k)
    """
    sums = np.zeros((int(groups.max()) + 1, values.shape[1]))
    np.add.at(sums, groups, values)
    return sums


def clustered_covariance(design: Array, residuals: Array, groups: Whole, inverse: Array) -> Array:
    """Return the covariance of least squares, from the scatter of whole groups.

    Residuals of one group may depend on each other in any way; those of two groups are
    independent. There is no correction for the number of groups.

    Parameters
    ----------
    design : ndarray, shape (W, k)
        Regressors.
    residuals : ndarray, shape (W,)
        Residuals of the fit.
    groups : ndarray of int, shape (W,)
        Group of each row, from 0 to G − 1.
    inverse : ndarray, shape (k, k)
        Inverse of the normal matrix, with the prior if there is one.

    Returns
    -------
    ndarray, shape (k, k)

    References
    ----------
    K.-Y. Liang, S. L. Zeger, "Longitudinal data analysis using generalized linear models",
    Biometrika 73 (1986).
    """
    scores = summed_by_group(design * residuals[:, None], groups)
    return np.asarray(inverse @ (scores.T @ scores) @ inverse)

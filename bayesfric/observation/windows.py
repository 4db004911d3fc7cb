"""Residual friction force, averaged in windows of the travel."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bayesfric.arrays import Array, Whole


@dataclass(frozen=True)
class Windows:
    """Residual forces against the motion, windows of trials or one a run.

    Parameters
    ----------
    row : ndarray of int, shape (R,)
        Trial or run of each window, ascending.
    residual_n : ndarray, shape (R,)
        Measured less that of the reference law [N].
    columns : ndarray, shape (R, q)
        What each local number adds [N].
    covariance : tuple of ndarray
        Of the measurement error of each trial's or run's windows [N²].
    wander : tuple of ndarray
        Of friction along the path of each trial, relative.
    covariates : mapping of str to ndarray, shape (R,)
        Where each window lies.
    counts : ndarray, shape (R,), or None
        How much each counts, 1 but for strays and for windows that overlap; None where all are 1.
    """

    row: Whole
    residual_n: Array
    columns: Array
    covariance: tuple[Array, ...]
    wander: tuple[Array, ...]
    covariates: Mapping[str, Array]
    counts: Array | None = None

    @property
    def variance(self) -> Array:
        """Of each window's measurement error, shape (R,) [N²]."""
        return np.concatenate([np.diag(part) for part in self.covariance])

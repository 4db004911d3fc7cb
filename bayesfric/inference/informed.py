"""Which parameters the data inform, and which only their priors."""

import numpy as np
from numpy.typing import NDArray

from bayesfric.inference.laplace import curvature_steps, finite_hessian
from bayesfric.inference.model import Model

__all__ = ["informed_by_data"]

Array = NDArray[np.float64]
OPEN = 1e-3
"""Least curvature of a direction: flatter ones differ by the error of finite differences only."""


def informed_by_data(model: Model, centre: Array) -> NDArray[np.bool_]:
    """Return whether the likelihood alone pins each parameter down better than its prior.

    From the curvature of the log likelihood, in units of the priors' widths: a direction
    that the data leave open has a curvature below 1. A direction counts as √1000 widths wide
    at most, so that what is mixed into it by less than 3 % is not open with it.

    Parameters
    ----------
    model : Model
        Of D parameters.
    centre : ndarray, shape (D,)
        Where the curvature is taken, in the parameters' units: a posterior median.

    Returns
    -------
    ndarray of bool, shape (D,)
    """
    z = model.sampling(centre)
    unit = model.scale()

    def log_likelihood(points: Array) -> Array:
        return model.log_likelihood(model.natural(points))

    step = curvature_steps(log_likelihood, z, 0.3 * unit)
    curvature = -finite_hessian(log_likelihood, z, step) * np.outer(unit, unit)
    values, vectors = np.linalg.eigh(curvature)
    variance = (vectors**2 / np.maximum(values, OPEN)).sum(axis=1)
    return np.asarray(variance < 1)

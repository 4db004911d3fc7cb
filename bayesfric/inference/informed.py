"""Which parameters the data inform, and which only their prior determines."""

import numpy as np
from numpy.typing import NDArray

from bayesfric.arrays import Array
from bayesfric.inference.laplace import curvature_steps, finite_hessian
from bayesfric.inference.model import Model

LEAST_CURVATURE = (
    1e-3  # least curvature of a direction: flatter ones differ by finite differences only
)
LINEAR_STEP = 1e-5  # step over which a change of coordinates is linear, in widths of the prior
SOME = 500  # draws among which the most probable one is near the mode


def informed_by_data(model: Model, draws: Array) -> NDArray[np.bool_]:
    """Return whether the data determine each parameter better than its prior does.

    The answer follows from the curvature of the log likelihood, in units of the priors' widths.
    A direction that the data do not determine has a curvature below 1. For coefficients, the
    likelihood alone must determine them, with priors only for all other parameters. Any other
    parameter is tested with the priors of all parameters, so that a scatter of 0, which cannot be
    determined, does not affect it.

    Parameters
    ----------
    model : Model
        Model with D parameters.
    draws : ndarray, shape (S, D)
        Draws of the posterior, in the parameters' units. The curvature is that at the most
        probable of some draws; along undetermined directions, medians can be improbable.

    Returns
    -------
    ndarray of bool, shape (D,)
    """
    some = model.sampling(draws[np.linspace(0, len(draws) - 1, SOME).astype(int)])
    z = some[np.argmax(model.log_posterior(some))]
    unit = model.scale()
    own = np.array([parameter.kind == "coefficient" for parameter in model.parameters])
    top, near = model.natural(np.array([z, z + LINEAR_STEP * unit]))
    slope = (near - top) / (LINEAR_STEP * unit)

    def log_likelihood(points: Array) -> Array:
        # Coefficients move on a straight line: along a curve, a slope would look like curvature.
        theta = model.natural(points)
        return model.log_likelihood(np.where(own, top + slope * (points - z), theta))

    step = curvature_steps(log_likelihood, z, 0.3 * unit)
    curvature = -finite_hessian(log_likelihood, z, step) * np.outer(unit, unit)
    values, vectors = np.linalg.eigh(curvature)
    # Away from the maximum of the likelihood, or by rounding, curvatures may be negative.
    information = (vectors * np.maximum(values, 0.0)) @ vectors.T
    posterior = np.linalg.inv(information + np.eye(z.size))
    informed = 1 / np.diag(posterior) - 1 > 1
    if own.any():
        rest = ~own
        across = information[np.ix_(own, rest)]
        taken = across @ np.linalg.solve(
            information[np.ix_(rest, rest)] + np.eye(rest.sum()), across.T
        )
        values, vectors = np.linalg.eigh(information[np.ix_(own, own)] - taken)
        informed[own] = (vectors**2 / np.maximum(values, LEAST_CURVATURE)).sum(axis=1) < 1
    return np.asarray(informed)

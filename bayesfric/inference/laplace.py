"""The mode of a log density and the normal distribution around it.

The input is a function of points (W, D) that returns log densities (W,), and a start. Derivatives
are central differences; all points of a Hessian are evaluated in one call.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy

from bayesfric.arrays import Array

LogDensity = Callable[[Array], Array]

DROP = 0.02  # change of the log density over the step of a finite difference [nat]
RESTARTS, STEPS = 60, 8  # most restarts of the search for the mode, and steps of each
SETTLED = 0.1  # tolerance of the logarithms of steps, which are only scales
LEAST_CURVATURE = 1e-3  # least eigenvalue of the whitened negative Hessian


class NoModeError(ValueError):
    """The search for the mode reached a point at which the curvature is not finite."""


@dataclass(frozen=True)
class Laplace:
    """A normal approximation of a density.

    Parameters
    ----------
    mode : ndarray, shape (D,)
        Point of the largest density.
    covariance : ndarray, shape (D, D)
        Inverse of the negative Hessian at the mode.
    log_density : float
        Log density at the mode.
    """

    mode: Array
    covariance: Array
    log_density: float


def laplace_approximation(log_density: LogDensity, start: Array, scale: Array) -> Laplace:
    """Find the mode of a density and its curvature there.

    Parameters
    ----------
    log_density : callable
        From points of shape (W, D) to log densities of shape (W,).
    start : ndarray, shape (D,)
        A point of finite density.
    scale : ndarray, shape (D,)
        Largest plausible scale of each coordinate, such as that of its prior.

    Returns
    -------
    Laplace
        The approximation at the best point.

    Raises
    ------
    ValueError
        If the density at `start` is not finite.
    NoModeError
        If the search reaches a point at which the curvature is not finite.
    """
    best = float(log_density(start[None])[0])
    if not np.isfinite(best):
        raise ValueError(f"the log density at the start is {best}, not finite")
    point, steps = start, 1e-3 * scale
    # Each restart rescales the coordinates by the present curvature. A Hessian costs as much as
    # dozens of gradients, so it is kept for some steps of the trust region.
    for _ in range(RESTARTS):
        steps = curvature_steps(log_density, point, scale, steps)
        curvature = _whitened(log_density, point, steps)

        def objective(u: Array, origin: Array = point, unit: Array = steps) -> float:
            return -float(log_density((origin + u * unit)[None])[0])

        def gradient(u: Array, origin: Array = point, unit: Array = steps) -> Array:
            return -_gradient(log_density, origin + u * unit, unit) * unit

        def hessian(u: Array, kept: Array = curvature) -> Array:
            del u
            return kept

        minimum = scipy.optimize.minimize(
            objective,
            np.zeros_like(point),
            method="trust-exact",
            jac=gradient,
            hess=hessian,
            options={"gtol": 1e-3, "maxiter": STEPS, "max_trust_radius": 100.0},
        )
        gain = -minimum.fun - best
        if gain > 0:
            point, best = point + minimum.x * steps, -float(minimum.fun)
        if gain < 1e-4:
            break
    values, vectors = np.linalg.eigh(curvature)
    inverse = (vectors / np.maximum(values, LEAST_CURVATURE)) @ vectors.T
    return Laplace(point, inverse * np.outer(steps, steps), best)


def _whitened(log_density: LogDensity, point: Array, unit: Array) -> Array:
    """Return minus the Hessian in units of each coordinate, (D, D)."""
    with np.errstate(invalid="ignore"):  # _finite raises an error
        return _finite(-finite_hessian(log_density, point, unit) * np.outer(unit, unit))


def _finite(derivatives: Array) -> Array:
    if not np.isfinite(derivatives).all():
        raise NoModeError("the log density has no finite curvature where it was climbed to")
    return derivatives


def finite_hessian(log_density: LogDensity, point: Array, unit: Array) -> Array:
    """Return the Hessian by central differences.

    Parameters
    ----------
    log_density : callable
        Points of shape (W, D) to log densities of shape (W,).
    point : ndarray, shape (D,)
        The point.
    unit : ndarray, shape (D,)
        Change of each coordinate that changes the log density by about 1/2.

    Returns
    -------
    ndarray, shape (D, D)
        Symmetric.
    """
    size = point.size
    step = np.sqrt(2 * DROP) * unit
    row, column = np.tril_indices(size, -1)
    shifts = np.diag(step)
    pairs = shifts[row], shifts[column]
    points = np.concatenate(
        [
            point[None],
            point + shifts,
            point - shifts,
            point + pairs[0] + pairs[1],
            point - pairs[0] - pairs[1],
        ]
    )
    value = log_density(points)
    centre, plus, minus = value[0], value[1 : size + 1], value[size + 1 : 2 * size + 1]
    second = plus - 2 * centre + minus
    together = np.add(*np.split(value[2 * size + 1 :], 2)) - 2 * centre
    hessian = np.diag(second / step**2)
    # The second difference along two coordinates at once contains twice the mixed derivative.
    mixed = (together - second[row] - second[column]) / (2 * step[row] * step[column])
    hessian[row, column] = hessian[column, row] = mixed
    return hessian


def _gradient(log_density: LogDensity, point: Array, unit: Array) -> Array:
    step = np.sqrt(2 * DROP) * unit
    value = log_density(np.concatenate([point + np.diag(step), point - np.diag(step)]))
    with np.errstate(invalid="ignore"):  # _finite raises an error
        return _finite((value[: point.size] - value[point.size :]) / (2 * step))


def curvature_steps(
    log_density: LogDensity, point: Array, scale: Array, first: Array | None = None
) -> Array:
    """Return the change of each coordinate that lowers the log density by about 1/2.

    Parameters
    ----------
    log_density : callable
        Points of shape (W, D) to log densities of shape (W,).
    point : ndarray, shape (D,)
        The point.
    scale : ndarray, shape (D,)
        Largest change of each coordinate.
    first : ndarray, shape (D,), or None
        First estimate, such as the result at a point nearby; None means a thousandth of `scale`.

    Returns
    -------
    ndarray, shape (D,)
        Changes, from the curvature along each coordinate.
    """
    steps = 1e-3 * scale if first is None else first
    for _ in range(6):
        shifts = np.diag(steps)
        value = log_density(np.concatenate([point[None], point + shifts, point - shifts]))
        size = point.size
        with np.errstate(divide="ignore", invalid="ignore"):
            second = np.abs(value[1 : size + 1] - 2 * value[0] + value[size + 1 :]) / steps**2
            wanted = 1 / np.sqrt(second)
        # Beyond an edge of the density a difference is not finite, and the step is reduced.
        changed = np.where(np.isfinite(second), np.minimum(wanted, scale), 0.1 * steps)
        settled = bool((np.abs(np.log(changed / steps)) < SETTLED).all())
        steps = changed
        if settled:
            break
    return steps

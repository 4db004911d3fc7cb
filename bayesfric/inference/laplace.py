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

DROP = 0.02  # step of a difference, in curvature standard deviations squared
RESTARTS, STEPS = 60, 8  # of a climb at most; steps of a restart
SETTLED = 0.1  # of the logarithm of steps: they are a scale, no more
LEAST_CURVATURE = 1e-3  # of the whitened Hessian; flatter directions are cut off here


class NoModeError(ValueError):
    """The climb of a log density ended where its curvature is not finite."""


@dataclass(frozen=True)
class Laplace:
    """A normal approximation.

    Parameters
    ----------
    mode : ndarray, shape (D,)
        Where the density is largest.
    covariance : ndarray, shape (D, D)
        Inverse of the negative Hessian there.
    log_density : float
        At the mode.
    """

    mode: Array
    covariance: Array
    log_density: float


def laplace_approximation(log_density: LogDensity, start: Array, scale: Array) -> Laplace:
    """Climb to the mode and measure the curvature.

    Parameters
    ----------
    log_density : callable
        Points of shape (W, D) to log densities of shape (W,).
    start : ndarray, shape (D,)
        A point of finite density.
    scale : ndarray, shape (D,)
        Widest plausible scale of each coordinate, such as its prior's.

    Returns
    -------
    Laplace
        At the best point found.

    Raises
    ------
    ValueError
        The density at `start` is not finite.
    NoModeError
        Its curvature is not finite on the way up.
    """
    best = float(log_density(start[None])[0])
    if not np.isfinite(best):
        raise ValueError(f"the log density at the start is {best}, not finite")
    point, steps = start, 1e-3 * scale
    # Restarting rescales the coordinates with the curvature found so far. One Hessian is good
    # for some steps of a trust region, and costs as much as dozens of gradients.
    for _ in range(RESTARTS):
        steps = curvature_steps(log_density, point, scale, steps)
        bent = _whitened(log_density, point, steps)

        def objective(u: Array, origin: Array = point, unit: Array = steps) -> float:
            return -float(log_density((origin + u * unit)[None])[0])

        def gradient(u: Array, origin: Array = point, unit: Array = steps) -> Array:
            return -_gradient(log_density, origin + u * unit, unit) * unit

        def hessian(u: Array, kept: Array = bent) -> Array:
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
    values, vectors = np.linalg.eigh(bent)
    inverse = (vectors / np.maximum(values, LEAST_CURVATURE)) @ vectors.T
    return Laplace(point, inverse * np.outer(steps, steps), best)


def _whitened(log_density: LogDensity, point: Array, unit: Array) -> Array:
    """Return minus the Hessian in units of each coordinate, (D, D)."""
    with np.errstate(invalid="ignore"):  # told by _finite
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
        Where.
    unit : ndarray, shape (D,)
        Over which each coordinate changes the log density by about 1/2.

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
    bent = plus - 2 * centre + minus
    together = np.add(*np.split(value[2 * size + 1 :], 2)) - 2 * centre
    hessian = np.diag(bent / step**2)
    # Along both at once the curvature is that of each, and twice the mixed one.
    mixed = (together - bent[row] - bent[column]) / (2 * step[row] * step[column])
    hessian[row, column] = hessian[column, row] = mixed
    return hessian


def _gradient(log_density: LogDensity, point: Array, unit: Array) -> Array:
    step = np.sqrt(2 * DROP) * unit
    value = log_density(np.concatenate([point + np.diag(step), point - np.diag(step)]))
    with np.errstate(invalid="ignore"):  # told by _finite
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
        Where.
    scale : ndarray, shape (D,)
        The largest change allowed.
    first : ndarray, shape (D,), or None
        A guess, such as those of a point nearby; None is a thousandth of the scale.

    Returns
    -------
    ndarray, shape (D,)
        From the curvature along each coordinate.
    """
    steps = 1e-3 * scale if first is None else first
    for _ in range(6):
        shifts = np.diag(steps)
        value = log_density(np.concatenate([point[None], point + shifts, point - shifts]))
        size = point.size
        with np.errstate(divide="ignore", invalid="ignore"):
            second = np.abs(value[1 : size + 1] - 2 * value[0] + value[size + 1 :]) / steps**2
            wanted = 1 / np.sqrt(second)
        # Beyond an edge of the density a difference is not finite: come closer.
        changed = np.where(np.isfinite(second), np.minimum(wanted, scale), 0.1 * steps)
        settled = bool((np.abs(np.log(changed / steps)) < SETTLED).all())
        steps = changed
        if settled:
            break
    return steps

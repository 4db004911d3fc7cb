"""The probability that measurements of one group all lie above their thresholds.

A trial at rest shows only that its friction is at least the drive. The trials of an assembly share
its deviations u. Their probability is

    log P = log ∫ N(u; m, V) ∏ᵢ Φ(aᵢᵀu − bᵢ) du,

with m and V the mean and covariance of u from other data, and Φ the independent error of each
trial. For one trial the integral has a closed form. For more, the log-concave integrand is
integrated by the trapezoid rule around its mode, which converges exponentially: the error is about
exp(−2 π² / (h² (1 + |a|²))) for a step of h, and the step follows the steepest a.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import log_ndtr, logsumexp

from bayesfric.arrays import Array
from bayesfric.inference.grouped_normal import LOG_2PI

NEWTON_STEPS = 20  # most steps of the search for the mode
MODE_TOLERANCE = 1e-6  # tolerance of the mode [sd of u]
REACH = 7.0  # distance of the outermost nodes from the mode [sd of u]
STEEPEST = 8.0  # √(1 + |a|²) up to which the step decreases with it; error below 1e-6 nat there


class Thresholds(NamedTuple):
    """Thresholds of M measurements of a group, in standard deviations of their own errors.

    Parameters
    ----------
    moved : ndarray, shape (R, W, M)
        a, the shift of a measurement by one standard deviation of each of the group's R ≤ 2
        deviations.
    gap : ndarray, shape (W, M)
        b, the distance from the mean of a measurement up to its threshold.
    """

    moved: Array
    gap: Array

    def of(self, members: NDArray[np.intp]) -> "Thresholds":
        """Return the thresholds of some measurements."""
        return Thresholds(self.moved[..., members], self.gap[..., members])

    def beside(self, other: "Thresholds") -> "Thresholds":
        """Return these thresholds together with others of the same group."""
        return Thresholds(*(np.concatenate(pair, -1) for pair in zip(self, other, strict=True)))


def log_probability_above(mean: Array, covariance: Array, above: Thresholds) -> Array:
    """Return the log probability that all measurements of a group lie above their thresholds.

    Parameters
    ----------
    mean : ndarray, shape (W, R)
        m, the mean of the group's deviations.
    covariance : ndarray, shape (W, R, R)
        V, their covariance; positive definite.
    above : Thresholds
        Thresholds of the group's measurements, at least one.

    Returns
    -------
    ndarray, shape (W,)
    """
    moved = np.moveaxis(above.moved, 0, -1)  # (W, M, R)
    gap = above.gap - np.einsum("wmr,wr->wm", moved, mean)
    slope = moved @ np.linalg.cholesky(covariance)
    if gap.shape[-1] == 1:
        spread = np.sqrt(1 + (slope[:, 0] ** 2).sum(axis=-1))
        return np.asarray(log_ndtr(-gap[:, 0] / spread))
    if slope.shape[-1] == 1:
        slope = np.concatenate([slope, np.zeros_like(slope)], axis=-1)
    return _integrated(slope, gap)


def _integrated(slope: Array, gap: Array) -> Array:
    """Return the log of the integral over two standard normal deviations, shape (W,)."""
    centre = _mode(slope, gap)
    _, axes = np.linalg.eigh(np.einsum("wmr,wms->wrs", slope, slope))
    slope = slope @ axes
    offset = (slope @ (axes.transpose(0, 2, 1) @ centre[..., None]))[..., 0] - gap
    nodes = [_nodes(slope[..., axis]) for axis in range(2)]
    at = (centre[:, None, :] @ axes)[:, 0]
    density = np.zeros(())
    along = offset[..., None, None]  # (W, M, first, second)
    for axis, (node, shape) in enumerate(zip(nodes, ((1, -1, 1), (1, 1, -1)), strict=True)):
        step = node.reshape(shape)
        density = density - 0.5 * (at[:, axis, None, None] + step) ** 2
        density = density + np.log(node[1] - node[0])
        along = along + slope[..., axis, None, None] * step[:, None]
    density = density - LOG_2PI + log_ndtr(along).sum(axis=1)
    return np.asarray(logsumexp(density, axis=(1, 2)))


def _nodes(slope: Array) -> Array:
    """Return nodes around 0, whose step decreases with the steepest slope along an axis."""
    steepest = np.sqrt(1 + float((slope**2).max()))
    return np.linspace(-REACH, REACH, 1 + int(np.ceil(2 * REACH * min(steepest, STEEPEST))))


def _mode(slope: Array, gap: Array) -> Array:
    """Return the mode of the integrand, shape (W, 2), by Newton's method."""
    identity = np.eye(slope.shape[-1])
    mode = np.zeros((len(gap), slope.shape[-1]))
    for _ in range(NEWTON_STEPS):
        place = np.einsum("wmr,wr->wm", slope, mode) - gap
        hazard = np.exp(-0.5 * (place**2 + LOG_2PI) - log_ndtr(place))
        bend = hazard * (hazard + place)
        curvature = identity + np.einsum("wm,wmr,wms->wrs", bend, slope, slope)
        gradient = np.einsum("wm,wmr->wr", hazard, slope) - mode
        change = np.linalg.solve(curvature, gradient[..., None])[..., 0]
        mode = mode + change
        if np.abs(change).max() < MODE_TOLERANCE:
            break
    return mode

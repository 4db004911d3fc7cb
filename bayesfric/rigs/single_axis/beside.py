"""Forces beside the law with unknown amounts, such as errors of a model or forces of other joints.

Each amount has a prior N(0, 1). On a given recording, many of these forces are similar, and many
are negligible. They are therefore replaced by their leading principal directions, whose amounts
also have priors N(0, 1).
"""

from dataclasses import dataclass, field

import numpy as np

from bayesfric.arrays import Array, Flags
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES

LEAST = 1e-3  # least rms of a direction that is kept, relative to the rms force of all windows
LEAST_OF_FRICTION = 2e-3  # the same relative to the mean force (friction); the smaller one counts
FRICTION_SHARE = 0.1  # least friction that is assumed for this, relative to the rms force
MOST = 120  # largest number of directions
NO_LESS = 0.02  # least residual rms in a rough estimate, relative to the rms force
ROUNDS = 3  # estimates of the residual rms
ALL = slice(None)  # all windows


@dataclass(frozen=True)
class Mixing:
    """The composition of the leading directions.

    Parameters
    ----------
    shares : ndarray, shape (K, C)
        Weight of each of C forces in each of K directions; its rows are orthonormal.
    left_out : float
        Prior rms of the omitted directions, relative to the rms force.
    """

    shares: Array = field(default_factory=lambda: np.zeros((0, 0)))
    left_out: float = 0.0


@dataclass(frozen=True)
class Amounts:
    """Amounts of forces beside the law, integrated out of the joint density of all windows.

    Given the law's coefficients x, the density is normal in the amounts c. Their mode is T (1, −x)
    with T = (B'WB + I)⁻¹ B'W (y, L), where y is the force, L are the law's columns and W is the
    inverse covariance of the windows. The integral is the density at the mode, times a factor with
    the determinant of B'WB + I. T is computed at the mode of the noise.

    Parameters
    ----------
    modes : ndarray, shape (K, n)
        T.
    eigenvalues : ndarray, shape (K,)
        Eigenvalues of B'WB.
    """

    modes: Array
    eigenvalues: Array

    @classmethod
    def of(cls, form: Array, width: int = 6) -> "Amounts":
        """Return the amounts of the last K columns.

        Parameters
        ----------
        form : ndarray, shape (n + K, n + K)
            Weighted inner products of the columns: force, law, and forces beside the law.
        width : int
            n, the number of columns of force and law.
        """
        own = form[width:, width:]
        modes = np.linalg.solve(own + np.eye(len(own)), form[width:, :width])
        return cls(np.asarray(modes), np.maximum(np.linalg.eigvalsh(own), 0.0))

    def without_modes(self, data: Array) -> Array:
        """Return force and law's columns minus the forces beside the law at their mode, (W, n)."""
        width = self.modes.shape[1]
        return np.asarray(data[:, :width] - data[:, width:] @ self.modes)

    def log_density(self, left: Array, scale: Array) -> Array:
        """Return the contribution of prior and determinant of the amounts to the log density, (S,).

        Parameters
        ----------
        left : ndarray, shape (S, n)
            (1, −x) of S parameter vectors.
        scale : ndarray, shape (S,)
            Scale of the windows' errors, relative to that at which T was computed.
        """
        modes = left @ self.modes.T
        open_still = np.log1p(self.eigenvalues / scale[:, None] ** 2).sum(axis=1)
        return np.asarray(-0.5 * ((modes**2).sum(axis=1) + open_still))


def leading(columns: Array, force: Array) -> tuple[Array, Mixing]:
    """Return the leading directions of forces whose amounts have priors N(0, 1).

    Parameters
    ----------
    columns : ndarray, shape (W, C)
        Force of each in each window, for an amount of 1 [N or N·m].
    force : ndarray, shape (W,)
        Force of the windows along the motion. Its mean is about friction, for any load [N or N·m].

    Returns
    -------
    directions : ndarray, shape (W, K)
        Force of each direction, for an amount of 1.
    mixing : Mixing
        The composition of the directions.
    """
    if not columns.size:
        return columns[:, :0], Mixing(np.zeros((0, columns.shape[1])))
    left, size, right = np.linalg.svd(columns, full_matrices=False)
    rms = size / np.sqrt(len(columns))
    rms_force = float(np.sqrt(np.mean(force**2))) or 1.0
    friction = max(abs(float(np.mean(force))), FRICTION_SHARE * rms_force)
    least_rms = min(LEAST * rms_force, LEAST_OF_FRICTION * friction)
    count = min(MOST, len(columns) // AXIS_RULES.rows_a_number, int(np.sum(rms > least_rms)))
    rms_left_out = float(np.sqrt(np.sum(rms[count:] ** 2))) / rms_force
    return left[:, :count] * size[:count], Mixing(right[:count], rms_left_out)


def rough_amounts(law: Array, beside: Array, force: Array, inside: Flags | slice = ALL) -> Array:
    """Return a rough estimate of the forces beside the law, (W,); see :func:`rough_shares`."""
    return np.asarray(beside @ rough_shares(law, beside, force, inside))


def rough_shares(law: Array, beside: Array, force: Array, inside: Flags | slice = ALL) -> Array:
    """Return rough estimates of the amounts of forces beside the law, (K,).

    Parameters
    ----------
    law : ndarray, shape (W, n)
        Columns of the law, whose coefficients have flat priors.
    beside : ndarray, shape (W, K)
        Force of each in each window, for an amount of 1; amounts have priors N(0, 1).
    force : ndarray, shape (W,)
        Force of the windows.
    inside : ndarray of bool, shape (W,), or slice
        Windows that are used.
    """
    if not beside.shape[1]:
        return np.zeros(0)
    columns = np.hstack([law, beside])[inside]
    width = np.maximum(np.abs(columns).max(axis=0, initial=0.0), 1e-300)
    prior = np.diag(np.concatenate([np.zeros(law.shape[1]), np.ones(beside.shape[1])]) / width)
    goal = np.concatenate([force[inside], np.zeros(len(prior))])
    rms_force = float(np.sqrt(np.mean(force[inside] ** 2)))
    error = 0.1 * rms_force
    for _ in range(ROUNDS):
        design = np.vstack([columns / width, error * prior])
        amounts = np.linalg.lstsq(design, goal, rcond=1e-9)[0] / width
        residual = force[inside] - columns @ amounts
        error = max(float(np.sqrt(np.mean(residual**2))), NO_LESS * rms_force)
    return np.asarray(amounts[law.shape[1] :])

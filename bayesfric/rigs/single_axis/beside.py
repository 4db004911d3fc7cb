"""Forces beside the law whose amounts nobody knows: errors of a model, pulls of other joints.

Each has an amount with a prior N(0, 1). Many of them are alike on a recording, and many do
nothing: what counts are the leading directions of all together, whose amounts are N(0, 1) too.
"""

from dataclasses import dataclass, field

import numpy as np

from bayesfric.arrays import Array, Flags
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES

LEAST = 1e-3  # of the rms force of all rows, that a direction adds at the least
LEAST_OF_FRICTION = 2e-3  # or of the mean force, which friction is, where that is less
FRICTION_SHARE = 0.1  # of the rms force, that friction counts as at the least
MOST = 120  # directions
NO_LESS = 0.02  # of the rms force, that is left at the least, in a rough estimate
ROUNDS = 3  # of the size of what is left


@dataclass(frozen=True)
class Mixing:
    """Of which forces the leading directions are made.

    Parameters
    ----------
    shares : ndarray, shape (K, C)
        Of each of C forces in each of K directions; rows are orthonormal.
    left_out : float
        Rms that directions which were left out may add, over the rms force.
    """

    shares: Array = field(default_factory=lambda: np.zeros((0, 0)))
    left_out: float = 0.0


@dataclass(frozen=True)
class Amounts:
    """Amounts of forces beside the law, integrated out of the density of all rows together.

    Given the law's numbers x the density is normal in the amounts c, whose mode is T (1, −x) with
    T = (B'WB + 1)⁻¹ B'W (y, L): y is the force, L are the law's columns and W is the inverse
    covariance of the rows. With the mode in their place, and the determinant of what is left open,
    they are integrated out. T is that of the most probable noise.

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
        """Return the amounts of the last columns.

        Parameters
        ----------
        form : ndarray, shape (n + K,) twice
            Weighted products of columns: the force, the law's, and those of the amounts.
        width : int
            n, the force and the law's columns.
        """
        own = form[width:, width:]
        modes = np.linalg.solve(own + np.eye(len(own)), form[width:, :width])
        return cls(np.asarray(modes), np.maximum(np.linalg.eigvalsh(own), 0.0))

    def taken_off(self, data: Array) -> Array:
        """Return rows of the force and the law's columns less the amounts' modes, (W, n)."""
        width = self.modes.shape[1]
        return np.asarray(data[:, :width] - data[:, width:] @ self.modes)

    def log_density(self, left: Array, scale: Array) -> Array:
        """Return what the amounts add to the log density, (S,).

        Parameters
        ----------
        left : ndarray, shape (S, n)
            (1, −x).
        scale : ndarray, shape (S,)
            Of the rows' errors, over those of T.
        """
        modes = left @ self.modes.T
        open_still = np.log1p(self.eigenvalues / scale[:, None] ** 2).sum(axis=1)
        return np.asarray(-0.5 * ((modes**2).sum(axis=1) + open_still))


def leading(columns: Array, force: Array) -> tuple[Array, Mixing]:
    """Return the leading directions of forces whose amounts are N(0, 1).

    Parameters
    ----------
    columns : ndarray, shape (W, C)
        What an amount of 1 of each adds to each row.
    force : ndarray, shape (W,)
        Of the rows, in the way's sense: its mean is friction, however much a joint carries.

    Returns
    -------
    directions : ndarray, shape (W, K)
        What an amount of 1 of each direction adds.
    mixing : Mixing
        Of what they are made.
    """
    if not columns.size:
        return columns[:, :0], Mixing(np.zeros((0, columns.shape[1])))
    left, size, right = np.linalg.svd(columns, full_matrices=False)
    rms = size / np.sqrt(len(columns))
    whole = float(np.sqrt(np.mean(force**2))) or 1.0
    friction = max(abs(float(np.mean(force))), FRICTION_SHARE * whole)
    least = min(LEAST * whole, LEAST_OF_FRICTION * friction)
    count = min(MOST, len(columns) // AXIS_RULES.rows_a_number, int(np.sum(rms > least)))
    rest = float(np.sqrt(np.sum(rms[count:] ** 2))) / whole
    return left[:, :count] * size[:count], Mixing(right[:count], rest)


def rough_amounts(law: Array, beside: Array, force: Array, inside: Flags) -> Array:
    """Return roughly what forces of unknown amounts add to each row, (W,); see `rough_shares`."""
    return np.asarray(beside @ rough_shares(law, beside, force, inside))


def rough_shares(law: Array, beside: Array, force: Array, inside: Flags) -> Array:
    """Return rough amounts of forces, (K,).

    Parameters
    ----------
    law : ndarray, shape (W, n)
        Columns of the law, whose numbers may be anything.
    beside : ndarray, shape (W, K)
        What an amount of 1 of each adds; amounts are N(0, 1).
    force : ndarray, shape (W,)
        Of the rows.
    inside : ndarray of bool, shape (W,)
        Rows that tell it.
    """
    if not beside.shape[1]:
        return np.zeros(0)
    columns = np.hstack([law, beside])[inside]
    width = np.maximum(np.abs(columns).max(axis=0, initial=0.0), 1e-300)
    prior = np.diag(np.concatenate([np.zeros(law.shape[1]), np.ones(beside.shape[1])]) / width)
    goal = np.concatenate([force[inside], np.zeros(len(prior))])
    whole = float(np.sqrt(np.mean(force[inside] ** 2)))
    error = 0.1 * whole
    for _ in range(ROUNDS):
        design = np.vstack([columns / width, error * prior])
        amounts = np.linalg.lstsq(design, goal, rcond=1e-9)[0] / width
        rest = force[inside] - columns @ amounts
        error = max(float(np.sqrt(np.mean(rest**2))), NO_LESS * whole)
    return np.asarray(amounts[law.shape[1] :])

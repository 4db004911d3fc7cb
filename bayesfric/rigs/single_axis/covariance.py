"""The covariance of windows: errors of position and force, and wander of friction along the path.

Windows of a piece (neighbours in one pass) are correlated, windows of different pieces are not. All
pieces are padded to the same length and inverted together.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.sparse import csr_array

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.rigs.single_axis.readings import Readings

LEAST = 1e-12  # relative increase of variances that makes a covariance invertible


@dataclass(frozen=True)
class Pieces:
    """Windows (rows) by piece, padded.

    Parameters
    ----------
    rows : ndarray of int, shape (C, M)
        Index of the row at each position of each piece; the total number of rows for padding.
    position, force : ndarray, shape (C, M, M)
        Covariance by unit errors of position (including the mass), and of force.
    apart : ndarray, shape (C, M, M)
        Travel between two rows [m or rad].
    moved : ndarray, shape (C, M)
        Friction that wanders [N or N·m].
    count : int
        Number of rows.
    """

    rows: Whole
    position: Array
    force: Array
    apart: Array
    moved: Array
    count: int

    @classmethod
    def of(cls, readings: Readings, mass: float, moved: Array, damping: float = 0.0) -> "Pieces":
        """Arrange rows in padded pieces.

        Parameters
        ----------
        readings : Readings
            The rows.
        mass : float
            Mass that multiplies errors of the acceleration [kg or kg·m²].
        moved : ndarray, shape (W,)
            Friction that wanders [N or N·m].
        damping : float
            Damping that multiplies errors of a servo's speed.
        """
        sizes = np.bincount(readings.piece)
        widest = int(sizes.max())
        rows = np.full((sizes.size, widest), readings.count, dtype=np.intp)
        first = np.concatenate([[0], np.cumsum(sizes)[:-1]])
        inside = np.arange(readings.count) - first[readings.piece]
        rows[readings.piece, inside] = np.arange(readings.count)
        there = rows < readings.count
        both = there[:, :, None] & there[:, None, :]
        lag = np.abs(np.subtract.outer(np.arange(widest), np.arange(widest)))

        earlier = np.minimum.outer(np.arange(widest), np.arange(widest))

        def banded(table: Array) -> Array:
            padded = np.zeros((readings.count + 1, table.shape[1] + 1))
            padded[:-1, :-1] = table
            return np.asarray(padded[rows[:, earlier], np.minimum(lag, table.shape[1])] * both)

        where = readings.mean_position
        at = np.concatenate([where, [0.0]])[rows]
        apart = np.abs(at[:, :, None] - at[:, None, :])
        return cls(
            rows,
            banded(readings.lag_of_positions(mass, damping)),
            banded(readings.force_lag),
            apart,
            np.concatenate([moved, [0.0]])[rows],
            readings.count,
        )

    def _parts(
        self, position: float, force: float, wander: float, length: float
    ) -> tuple[Array, Array, Array]:
        products = self.moved[:, :, None] * self.moved[:, None, :]
        shape = np.exp(-self.apart / length)
        return position**2 * self.position, force**2 * self.force, wander**2 * products * shape

    def solved(self, position: float, force: float, wander: float, length: float) -> "Solved":
        """Return the inverse covariance at given noise parameters.

        Parameters
        ----------
        position, force : float
            Standard deviations of the errors at a sample.
        wander : float
            Relative rms of the friction that wanders.
        length : float
            Its correlation length.
        """
        parts = self._parts(position, force, wander, length)
        whole = parts[0] + parts[1] + parts[2]
        diagonal = np.einsum("cmm->cm", whole)
        diagonal += np.where(self.rows < self.count, LEAST * diagonal.max(), 1.0)
        return Solved(self, np.asarray(np.linalg.inv(whole)), whole, parts, length)

    def covariance(self, position: float, force: float, wander: float, length: float) -> csr_array:
        """Return the covariance of all rows at given noise parameters, shape (W, W)."""
        whole = sum(self._parts(position, force, wander, length))
        there = self.rows < self.count
        both = there[:, :, None] & there[:, None, :]
        row = np.broadcast_to(self.rows[:, :, None], both.shape)[both]
        column = np.broadcast_to(self.rows[:, None, :], both.shape)[both]
        return csr_array((np.asarray(whole)[both], (row, column)), (self.count, self.count))


@dataclass(frozen=True)
class Solved:
    """The inverse covariance at given noise parameters.

    Parameters
    ----------
    pieces : Pieces
        The rows.
    inverse, whole : ndarray, shape (C, M, M)
        Inverse covariance, and covariance.
    parts : tuple of ndarray, shape (C, M, M)
        The parts of the covariance by errors of position, errors of force, and wander.
    length : float
        Correlation length of the wander.
    """

    pieces: Pieces
    inverse: Array
    whole: Array
    parts: tuple[Array, Array, Array]
    length: float

    def times(self, values: Array) -> Array:
        """Return the inverse covariance times values, of their shape (W, …)."""
        flat = values.reshape(values.shape[0], -1)
        padded = np.concatenate([flat, np.zeros((1, flat.shape[1]))])[self.pieces.rows]
        product = np.empty((self.pieces.count + 1, flat.shape[1]))
        product[self.pieces.rows] = self.inverse @ padded
        return product[:-1].reshape(values.shape)

    def grams(self, values: Array, trial: Whole) -> Array:
        """Return the products of columns in each trial, under the inverse, (N, k, k)."""
        weighted = self.times(values)
        ends = [*np.flatnonzero(np.diff(trial, prepend=-1)), trial.size]
        return np.stack([values[i:j].T @ weighted[i:j] for i, j in pairwise(ends)])

    def log_determinant(self, kept: Flags) -> float:
        """Return the log determinant of the covariance of the kept rows (whole pieces)."""
        used = kept[self.pieces.rows[:, 0]]
        return float(np.linalg.slogdet(self.whole[used])[1].sum())

    def gradient(
        self, pulls: Array, pulled: Array, taken: Array, trial: Whole, kept: Flags
    ) -> dict[str, float]:
        """Return derivatives of the log evidence by log noise parameters.

        Parameters
        ----------
        pulls : ndarray, shape (W, m)
            Inverse covariance with shared deviations integrated out, times the residual, and times
            the columns multiplied by a root of the covariance of their coefficients.
        pulled : ndarray, shape (W, k)
            Inverse covariance of the rows' own errors, times the columns of deviations.
        taken : ndarray, shape (N, k, k)
            For each run, the matrix that integration over deviations subtracts from the inverse,
            between these columns.
        trial : ndarray of int, shape (W,)
            Run of each row.
        kept : ndarray of bool, shape (W,)
            Rows that are used.
        """
        rows = self.pieces.rows
        used = kept[rows[:, 0]]

        def padded(values: Array) -> Array:
            return np.concatenate([values, np.zeros((1, *values.shape[1:]))])[rows][used]

        of_pulls, of_pulled = padded(pulls), padded(pulled)
        square = of_pulls @ of_pulls.swapaxes(1, 2) - self.inverse[used]
        square += of_pulled @ taken[trial[rows[used, 0]]] @ of_pulled.swapaxes(1, 2)
        position, force, wander = (part[used] for part in self.parts)
        stretched = wander * self.pieces.apart[used] / self.length
        return {
            "sigma_position": float((square * position).sum()),
            "sigma_force": float((square * force).sum()),
            "wander_axis": float((square * wander).sum()),
            "wander_length_axis": 0.5 * float((square * stretched).sum()),
        }

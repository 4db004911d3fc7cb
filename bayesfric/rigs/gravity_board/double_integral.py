"""Double integrals of accelerations along the paths of trials, evaluated at the events."""

from dataclasses import dataclass
from functools import cache

import numpy as np
import scipy
from scipy.sparse import csr_array

from bayesfric.arrays import Array, Whole

ROWS_AT_ONCE = 4096  # rows whose columns are computed together: all would need too much memory
POINTS = 129  # times of the grid of a path; odd, for Simpson's rule


@dataclass(frozen=True)
class DoubleIntegral:
    """The map from accelerations along paths to displacements at rows.

    Parameters
    ----------
    trial : ndarray of int, shape (E,)
        Trial of each row, ascending.
    place : ndarray, shape (E,)
        Time of each row on the grid of its trial, in steps of the grid.
    step_s : ndarray, shape (E,)
        Step of this grid [s].
    trials : int
        Number of trials, N.
    """

    trial: Whole
    place: Array
    step_s: Array
    trials: int

    def of(self, acceleration: Array) -> Array:
        """Return the displacement at each row.

        Parameters
        ----------
        acceleration : ndarray, shape (C, N, P)
            C accelerations along the path of each trial [m/s²].

        Returns
        -------
        ndarray, shape (E, C)
            Displacements, by cubic Hermite interpolation on the grid [m].
        """
        at_places = np.concatenate(integrals(), axis=1).T
        ends = np.searchsorted(self.trial, np.arange(self.trials + 1))
        displacement = np.empty((self.trial.size, len(acceleration)))
        start = 0  # a few trials at a time: an array of all rows by all grid times is large
        while start < self.trials:
            stop = int(np.searchsorted(ends, ends[start] + ROWS_AT_ONCE, side="right")) - 1
            stop = max(stop, start + 1)
            added = self._at_rows(slice(ends[start], ends[stop])) @ at_places
            for trial in range(start, stop):
                rows = slice(ends[trial], ends[trial + 1])
                own = added[rows.start - ends[start] : rows.stop - ends[start]]
                np.matmul(own, acceleration[:, trial].T, out=displacement[rows])
            start = stop
        return displacement

    def _at_rows(self, rows: slice) -> csr_array:
        """Return the weights of speed and travel on a grid of unit steps for some rows, (e, 2 P).

        They are the weights of cubic Hermite interpolation, with the units of the rows' grids.
        """
        left = np.minimum(self.place[rows].astype(int), POINTS - 2)
        share = self.place[rows] - left
        rise = share**2 * (3 - 2 * share)
        bend = share * (1 - share)
        weights = np.stack([bend * (1 - share), -bend * share, 1 - rise, rise], axis=1)
        weights *= self.step_s[rows, None] ** 2
        places = left[:, None] + [0, 1, POINTS, POINTS + 1]
        ends = np.arange(0, weights.size + 1, 4)
        return csr_array((weights.ravel(), places.ravel(), ends), shape=(left.size, 2 * POINTS))


@cache
def integrals() -> tuple[Array, Array]:
    """Return matrices of the first and second integral of values on a grid of unit steps.

    A row of values times such a matrix is the row of its integrals, shape (P, P) each.
    """
    first = scipy.integrate.cumulative_simpson(np.eye(POINTS), axis=1, initial=0)
    return first, np.asarray(scipy.integrate.cumulative_simpson(first, axis=1, initial=0))

"""Decelerations on the grids of the trials' paths, integrated twice, at the events."""

from dataclasses import dataclass
from functools import cache

import numpy as np
import scipy
from scipy.sparse import csr_array

from bayesfric.arrays import Array, Whole

ROWS_AT_ONCE = 4096  # of which columns are made: more would be most of what a diagnosis holds
POINTS = 129  # of the grid in time; odd, for Simpson's rule


@dataclass(frozen=True)
class DoubleIntegral:
    """From accelerations along the paths to displacements of rows.

    Parameters
    ----------
    trial : ndarray of int, shape (E,)
        Of each row, ascending.
    place : ndarray, shape (E,)
        On the grid of its trial, in steps.
    step_s : ndarray, shape (E,)
        Of that grid [s].
    trials : int
        How many there are, N.
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
            Along the paths [m/s²].

        Returns
        -------
        ndarray, shape (E, C)
            By cubic Hermite interpolation on the grid [m].
        """
        at_places = np.concatenate(integrals(), axis=1).T
        ends = np.searchsorted(self.trial, np.arange(self.trials + 1))
        displacement = np.empty((self.trial.size, len(acceleration)))
        start = 0  # some trials at a time: all rows by all places would be a large array
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
        """Return what speeds and travels on a grid of unit steps add to some rows, (e, 2 P)."""
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
    """Return what turns values on a grid of unit steps into their first and second integral."""
    first = scipy.integrate.cumulative_simpson(np.eye(POINTS), axis=1, initial=0)
    return first, np.asarray(scipy.integrate.cumulative_simpson(first, axis=1, initial=0))

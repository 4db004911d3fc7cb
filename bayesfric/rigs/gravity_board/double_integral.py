"""Decelerations on the grids of the trials' paths, integrated twice, at the events."""

from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from scipy.integrate import cumulative_simpson
from scipy.sparse import csr_array

from bayesfric.arrays import Array, Whole
from bayesfric.rigs.gravity_board.paths import POINTS

__all__ = ["DoubleIntegral"]


@dataclass(frozen=True)
class DoubleIntegral:
    """From accelerations along the paths to displacements of rows.

    Parameters
    ----------
    trial : ndarray of int, shape (E,)
        Of each row.
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
        # By trial and place, both integrals of a trial one below the other.
        along = np.ascontiguousarray(np.moveaxis(acceleration, 0, 2))
        both = _integrals() @ along
        return np.asarray(self._at_rows @ both.reshape(-1, len(acceleration)))

    @cached_property
    def _at_rows(self) -> csr_array:
        """What speeds and travels on the grids add to the displacement of rows, (E, 2 N P)."""
        left = np.minimum(self.place.astype(int), POINTS - 2)
        share = self.place - left
        rise = share**2 * (3 - 2 * share)
        # On a grid of unit steps; a step is of this many seconds.
        values = self.step_s**2 * np.stack(
            [share * (1 - share) ** 2, -(share**2) * (1 - share), 1 - rise, rise]
        )
        places = 2 * self.trial * POINTS + left + np.array([[0], [1], [POINTS], [POINTS + 1]])
        ends = np.arange(0, values.size + 1, len(values))
        shape = (left.size, 2 * self.trials * POINTS)
        return csr_array((values.T.ravel(), places.T.ravel(), ends), shape=shape)


@cache
def _integrals() -> Array:
    """Return what turns values on a grid of unit steps into both integrals, (2 P, P)."""
    first = cumulative_simpson(np.eye(POINTS), axis=1, initial=0)
    second = cumulative_simpson(first, axis=1, initial=0)
    return np.concatenate([first, second], axis=1).T.copy()

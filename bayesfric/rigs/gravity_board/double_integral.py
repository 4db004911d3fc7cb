"""Decelerations on the grids of the trials' paths, integrated twice, at the events."""

from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
import scipy
from scipy.sparse import csr_array

from bayesfric.arrays import Array, Whole

POINTS = 129  # of the grid in time; odd, for Simpson's rule


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
        of_speeds, of_travels = self._at_rows
        first, second = integrals()
        # One after another: small arrays stay in the processor's cache.
        return np.stack(
            [
                of_speeds @ (column @ first).ravel() + of_travels @ (column @ second).ravel()
                for column in acceleration
            ],
            axis=1,
        )

    @cached_property
    def _at_rows(self) -> tuple[csr_array, csr_array]:
        """What speeds and travels on the grids add to the displacement of rows, (E, N P)."""
        left = np.minimum(self.place.astype(int), POINTS - 2)
        share = self.place - left
        rise = share**2 * (3 - 2 * share)
        place = self.trial * POINTS + left
        ends = np.arange(0, 2 * place.size + 1, 2)

        def weights(*at_ends: Array) -> csr_array:
            # On a grid of unit steps; a step is of this many seconds.
            values = (self.step_s**2 * np.stack(at_ends)).T
            columns = np.stack([place, place + 1], axis=1)
            shape = (place.size, self.trials * POINTS)
            return csr_array((values.ravel(), columns.ravel(), ends), shape=shape)

        speeds = weights(share * (1 - share) ** 2, -(share**2) * (1 - share))
        return speeds, weights(1 - rise, rise)


@cache
def integrals() -> tuple[Array, Array]:
    """Return what turns values on a grid of unit steps into their first and second integral."""
    first = scipy.integrate.cumulative_simpson(np.eye(POINTS), axis=1, initial=0)
    return first, np.asarray(scipy.integrate.cumulative_simpson(first, axis=1, initial=0))

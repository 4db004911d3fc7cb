"""Decelerations on the grids of the trials' paths, integrated twice, at the events."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_simpson

from bayesfric.rigs.gravity_board.paths import POINTS

__all__ = ["DoubleIntegral"]

Array = NDArray[np.float64]


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
    """

    trial: NDArray[np.intp]
    place: Array
    step_s: Array

    def of(self, acceleration: Array) -> Array:
        """Return the displacement at each row.

        Parameters
        ----------
        acceleration : ndarray, shape (C, N, P)
            Along the paths [m/s²].

        Returns
        -------
        ndarray, shape (C, E)
            By cubic Hermite interpolation on the grid [m].
        """
        flat = acceleration.reshape(-1, POINTS)
        speeds, travels = (flat @ one for one in _integrals())
        trial, left = self.trial, np.minimum(self.place.astype(int), POINTS - 2)
        share = self.place - left
        rise = share**2 * (3 - 2 * share)
        travels, speeds = travels.reshape(acceleration.shape), speeds.reshape(acceleration.shape)
        # On a grid of unit steps; a step is of this many seconds.
        found = (1 - rise) * travels[:, trial, left] + rise * travels[:, trial, left + 1]
        found += share * (1 - share) ** 2 * speeds[:, trial, left]
        found -= share**2 * (1 - share) * speeds[:, trial, left + 1]
        return np.asarray(self.step_s**2 * found)


@cache
def _integrals() -> tuple[Array, Array]:
    """Return what turns values on a grid of unit steps into their first and second integral."""
    first = cumulative_simpson(np.eye(POINTS), axis=1, initial=0)
    return first, np.asarray(cumulative_simpson(first, axis=1, initial=0))

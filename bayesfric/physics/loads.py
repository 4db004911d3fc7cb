"""A load behind a transmission: it stands still while the drive moves on, and then follows."""

import numpy as np
from numpy.typing import ArrayLike

from bayesfric.arrays import Array

__all__ = ["taken_along"]


def taken_along(
    travel: ArrayLike, speed: ArrayLike, length: ArrayLike, sharp: float
) -> tuple[Array, Array]:
    """Return what part of a load is left behind, and the acceleration that takes it along.

    Parameters
    ----------
    travel, speed : array_like
        Of the drive since its last reversal [m], [m/s]; radians where it turns.
    length : array_like
        Travel at the end of which the load moves [m].
    sharp : float
        One over the share of `length` over which it is taken along.

    Returns
    -------
    behind : ndarray
        From 1 after the reversal to 0.
    acceleration : ndarray
        [m/s²]: its integral over time is the drive's speed, which the load lacks.
    """
    whole = np.asarray(length)
    end = np.tanh(sharp * (np.asarray(travel) / whole - 1))
    density = 0.5 * sharp * (1 - end**2) / whole
    return 0.5 * (1 - end), np.asarray(speed) ** 2 * density

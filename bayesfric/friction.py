"""The paper's friction law, eqs. (15) and (16), without time.

All functions broadcast: arguments may be numbers or arrays.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["REFERENCE_WRAP_ANGLE_DEG", "Coefficients", "coulomb_friction", "tension_slope"]

REFERENCE_WRAP_ANGLE_DEG = 85.0
"""Average individual wrap angle at which c3 has no effect, eq. (15) [deg]."""


class Coefficients(NamedTuple):
    """Coefficients of the friction law of one pulley size (or arrays of them).

    Parameters
    ----------
    c1 : array_like
        Friction per tension and pulley at 85° [-].
    c2 : array_like
        Friction a pulley at no tension [N].
    c3 : array_like
        Change of c1 with the average wrap angle [1/deg].
    """

    c1: ArrayLike
    c2: ArrayLike
    c3: ArrayLike


def tension_slope(
    coefficients: Coefficients, n_pulleys: ArrayLike, wrap_angle_deg: ArrayLike
) -> NDArray[np.float64]:
    """Return dfc/dT = n (c1 + c3 (θ − 85°)), the slope in tension of eq. (15).

    Parameters
    ----------
    coefficients : Coefficients
        Of the pulley size.
    n_pulleys : array_like
        Number of pulleys.
    wrap_angle_deg : array_like
        Average individual wrap angle [deg].

    Returns
    -------
    ndarray
        Newton of friction per newton of nominal tension.
    """
    wrap = np.asarray(wrap_angle_deg) - REFERENCE_WRAP_ANGLE_DEG
    slope = np.asarray(coefficients.c1) + np.asarray(coefficients.c3) * wrap
    return np.asarray(n_pulleys * slope, dtype=np.float64)


def coulomb_friction(
    coefficients: Coefficients,
    n_pulleys: ArrayLike,
    wrap_angle_deg: ArrayLike,
    tension_n: ArrayLike,
) -> NDArray[np.float64]:
    """Return fc = n ((c1 + c3 (θ − 85°)) T + c2), eq. (15) of the paper.

    Parameters
    ----------
    coefficients : Coefficients
        Of the pulley size.
    n_pulleys : array_like
        Number of pulleys.
    wrap_angle_deg : array_like
        Average individual wrap angle [deg].
    tension_n : array_like
        Nominal tension [N].

    Returns
    -------
    ndarray
        Coulomb friction force along the cable [N]; it acts against the motion.
    """
    slope = tension_slope(coefficients, n_pulleys, wrap_angle_deg)
    return slope * np.asarray(tension_n) + np.asarray(n_pulleys) * np.asarray(coefficients.c2)

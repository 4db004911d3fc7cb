"""The friction law without time: the paper's eqs. (15) and (16), and pulley by pulley.

The paper takes the friction of n pulleys as n times that of one at a nominal
tension. Pulley by pulley (`recursive`), the tension drops on the way from the
pulling end to the load, T_{i+1} = (1 − a_i) T_i − c2 with a_i = c1 + c3 (θ_i − 85°),
so each pulley rubs at the tension that is left. A whole run of pulleys then maps
the tension of one end to that of the other by a straight line,
:class:`TensionLoss`; its friction is the difference of the two.

All functions broadcast: arguments may be numbers or arrays.
"""

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

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
    c1, c3 = _floats(coefficients.c1), _floats(coefficients.c3)
    return _floats(n_pulleys) * (c1 + c3 * (_floats(wrap_angle_deg) - REFERENCE_WRAP_ANGLE_DEG))


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
    return slope * _floats(tension_n) + _floats(n_pulleys) * _floats(coefficients.c2)


class TensionLoss(NamedTuple):
    """What a run of pulleys takes from the tension: T_load = (1 − share) T_drive − constant.

    Drive is the end that pulls, where tension is higher; load is the end that is
    pulled, where it is lower.

    Parameters
    ----------
    share : ndarray
        Share of the drive-side tension that is lost, 1 − Π(1 − a_i) [-].
    constant_n : ndarray
        Loss at no tension, c2 Σ_i Π_{j>i}(1 − a_j) [N].
    """

    share: NDArray[np.float64]
    constant_n: NDArray[np.float64]


def equal_pulleys(
    coefficients: Coefficients, n_pulleys: ArrayLike, wrap_angle_deg: ArrayLike
) -> TensionLoss:
    """Return the tension loss over n pulleys of one wrap angle, a geometric series.

    Parameters
    ----------
    coefficients : Coefficients
        Of the pulley size; a = c1 + c3 (θ − 85°) below 1.
    n_pulleys : array_like
        Number of pulleys.
    wrap_angle_deg : array_like
        Wrap angle of each pulley [deg].

    Returns
    -------
    TensionLoss
        share = 1 − (1 − a)^n and constant = c2 share / a, which is n c2 at a = 0.
    """
    a = tension_slope(coefficients, 1.0, wrap_angle_deg)
    n = _floats(n_pulleys)
    # expm1 and log1p keep every digit of a small a, where 1 − (1 − a)^n cancels
    share = -np.expm1(n * np.log1p(-a))
    passes = np.where(a == 0, n, share / np.where(a == 0, 1.0, a))
    return TensionLoss(share, _floats(coefficients.c2) * passes)


def in_a_row(shares: ArrayLike, constant_n: ArrayLike) -> TensionLoss:
    """Return the tension loss over pulleys that each take a share and a constant.

    Parameters
    ----------
    shares : array_like, shape (..., n)
        a_i of each pulley, below 1, from the drive to the load [-].
    constant_n : array_like, shape (...)
        c2, of every pulley [N].

    Returns
    -------
    TensionLoss
        Of shape (...).
    """
    log_kept = np.log1p(-_floats(shares))
    total = log_kept.sum(axis=-1)
    # what is lost at pulley i is pulled through the pulleys after it
    passes = np.exp(total[..., None] - np.cumsum(log_kept, axis=-1)).sum(axis=-1)
    return TensionLoss(-np.expm1(total), _floats(constant_n) * passes)


def recursive_friction(
    loss: TensionLoss, tension_n: ArrayLike, tension_at: Literal["drive", "load", "mean"]
) -> NDArray[np.float64]:
    """Return the friction of a run of pulleys, T_drive − T_load, from one known tension.

    Parameters
    ----------
    loss : TensionLoss
        Of the run.
    tension_n : array_like
        The known tension [N].
    tension_at : {"drive", "load", "mean"}
        Where that tension is: at the end that pulls, at the end that is pulled, or as
        the mean of both.

    Returns
    -------
    ndarray
        Friction [N].
    """
    at_drive = loss.share * _floats(tension_n) + loss.constant_n
    match tension_at:
        case "drive":
            return at_drive
        case "load":
            return at_drive / (1 - loss.share)
        case "mean":
            return at_drive / (1 - loss.share / 2)
    raise ValueError(f"tension_at is {tension_at!r}; it is 'drive', 'load' or 'mean'")


def _floats(values: ArrayLike) -> NDArray[np.float64]:
    return np.asarray(values, dtype=np.float64)

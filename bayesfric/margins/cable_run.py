"""Friction, efficiency and lost motion of the pulleys of a loop.

Friction is the part of the cable force at the motor's capstan that opposes the motion [N].
In "driving" motion the motor pulls the load; in "overhauling" motion the load pulls the
motor.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from bayesfric.arrays import Array
from bayesfric.margins.loop_cables import CableRun
from bayesfric.physics.friction import (
    REFERENCE_WRAP_ANGLE_DEG,
    Coefficients,
    TensionLoss,
    in_a_row,
    recursive_friction,
)

Direction = Literal["driving", "overhauling"]
DIRECTIONS: tuple[Direction, ...] = ("driving", "overhauling")


@dataclass(frozen=True)
class RunFriction:
    """Friction of one run of pulleys, every array of shape (draws,).

    Parameters
    ----------
    nominal : ndarray
        Eq. (15) at the known tension, both sides of an antagonist pair added [N].
    recursive : ndarray
        The same, pulley by pulley. For an open run it is the mean of both directions, which is
        half of the force difference between pulling and giving way [N].
    loop : ndarray
        The one of the two that the run's `model` names [N].
    efficiency : ndarray
        η = Π(1 − a_i), the share of a change of tension that the run transmits [-].
    lost_length : ndarray
        Cable length that friction stores behind a motor at rest, times EA: Σ f_i x_i, with the
        friction f_i of pulley i and the cable length x_i from the motor to it [N·m].
    """

    nominal: Array
    recursive: Array
    loop: Array
    efficiency: Array
    lost_length: Array


def losses(
    coefficients: Coefficients, factor: ArrayLike, angles_deg: ArrayLike, *, clipped: bool = True
) -> Array:
    """Return a_i = f (c1 + c3 (θ_i − 85°)) of each pulley, none negative.

    Parameters
    ----------
    coefficients : Coefficients
        Arrays of shape (draws,).
    factor : array_like, shape (draws,)
        Friction of this assembly over that of the law [-].
    angles_deg : array_like, shape (n,)
        Wrap angles, from the motor to the load [deg].
    clipped : bool
        False returns the law unchanged, which may be negative far from the measured angles.

    Returns
    -------
    ndarray, shape (draws, n)
        Share of tension that is lost at each pulley [-].
    """
    c1, c3 = (np.asarray(part, float)[:, None] for part in (coefficients.c1, coefficients.c3))
    wrap = np.asarray(angles_deg, float)[None, :] - REFERENCE_WRAP_ANGLE_DEG
    a = np.asarray(np.asarray(factor, float)[:, None] * (c1 + c3 * wrap))
    return np.maximum(a, 0.0) if clipped else a


def run_friction(
    run: CableRun,
    coefficients: Coefficients,
    factor: Array,
    tension: Array,
    length: Array,
    factor_of_c2: Array,
) -> RunFriction:
    """Return the friction of a run of pulleys.

    Parameters
    ----------
    run : CableRun
        Pulleys, topology, and where the tension is known.
    coefficients : Coefficients
        Coefficients of its pulley size, shape (draws,).
    factor : ndarray, shape (draws,)
        Friction of this assembly over that of the law [-].
    tension : ndarray, shape (draws,)
        The known tension [N].
    length : ndarray, shape (draws,)
        Cable between motor and joint [m].
    factor_of_c2 : ndarray, shape (draws,)
        The same for c2, which scatters by itself as well [-].

    Returns
    -------
    RunFriction
        For an antagonist pair, friction of both sides: one pulls while the other gives way.
    """
    factor = np.maximum(factor, 0.0)
    c2 = np.maximum(np.asarray(coefficients.c2) * np.maximum(factor_of_c2, 0.0), 0.0)
    angles = np.asarray(run.angles_deg)
    a = losses(coefficients, factor, angles)
    sides = 2.0 if run.topology == "antagonist-pair" else 1.0
    by_pulley = a * tension[:, None] + c2[:, None]
    pulling = in_a_row(a, c2)
    # The load pulls at its own end, so the order of the pulleys is reversed.
    giving = in_a_row(a[:, ::-1], c2)
    recursive = sides / 2 * (_friction(pulling, run, tension, "driving")
                             + _friction(giving, run, tension, "overhauling"))  # fmt: skip
    nominal = sides * by_pulley.sum(axis=1)
    chosen = recursive if run.model == "recursive" else nominal
    place = length[:, None] * (np.arange(run.count) + 0.5)[None, :] / run.count
    if run.distance_m is not None:
        place = np.broadcast_to(np.asarray(run.distance_m)[None, :], by_pulley.shape)
    # Friction is divided among pulleys as by eq. (15); for a pair, each side counts once.
    share = np.divide(by_pulley, by_pulley.sum(axis=1, keepdims=True), out=np.zeros_like(by_pulley),
                      where=by_pulley.sum(axis=1, keepdims=True) != 0)  # fmt: skip
    lost = chosen / sides * (share * place).sum(axis=1)
    return RunFriction(nominal, recursive, chosen, 1 - pulling.share, lost)


def _friction(loss: TensionLoss, run: CableRun, tension: Array, direction: Direction) -> Array:
    """Return the friction of one side that moves in one direction [N]."""
    if run.tension_known_at == "mean":
        return recursive_friction(loss, tension, "mean")
    pulls = {"driving": "motor", "overhauling": "load"}[direction]
    return recursive_friction(loss, tension, "drive" if run.tension_known_at == pulls else "load")

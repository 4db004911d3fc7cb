"""Smooth forces that every hypothesis has, and how wide an unknown one makes some of them."""

from dataclasses import dataclass

import numpy as np

from bayesfric.inference.smooths import Smooth, smooth_along
from bayesfric.rigs.gravity_board.rows import GravityRows
from bayesfric.rigs.motor_board.linear import MotorPart

__all__ = ["Wide", "smooth_forces"]

SHARED_AXES = ("velocity", "tension", "n_pulleys", "wrap_angle")
TRIAL_AXES = ("displacement", "order", "acceleration")
RELATIVE_AXES = ("n_pulleys", "displacement", "order", "acceleration")  # also a share of friction


@dataclass(frozen=True)
class Wide:
    """Smooth forces beyond the discrepancy that every hypothesis has.

    Parameters
    ----------
    share : float
        Rms of the forces that are wide, as a share of rms friction.
    smooths : tuple of int
        Their places; the others are as wide as the discrepancy.
    """

    share: float
    smooths: tuple[int, ...]


def smooth_forces(rows: GravityRows | None, motor: MotorPart | None) -> tuple[Smooth, ...]:
    """Return the smooth forces along whatever varied on the boards.

    Parameters
    ----------
    rows : GravityRows or None
    motor : MotorPart or None
        The boards. What is of one board alone depends on its own covariates.
    """
    found: list[Smooth | None] = []
    here = [part.covariates() for part in (rows, motor) if part is not None]
    ranges = {
        axis: (
            min(float(np.min(where[axis])) for where in here),
            max(float(np.max(where[axis])) for where in here),
        )
        for axis in SHARED_AXES
    }
    both = ("velocity", "tension")
    for axis in SHARED_AXES:
        found += _along(axis, ranges[axis])
    found.append(smooth_along({axis: ranges[axis] for axis in both}))
    if rows is not None:
        where = rows.covariates()
        for axis in TRIAL_AXES:
            limits = (float(np.min(where[axis])), float(np.max(where[axis])))
            found += _along(axis, limits, "gravity")
    if rows is not None and motor is not None:
        where = motor.covariates()
        for axis in SHARED_AXES:
            limits = (float(np.min(where[axis])), float(np.max(where[axis])))
            found.append(smooth_along({axis: limits}, "motor"))
        found.append(smooth_along({}, "motor", relative=True))
    return tuple(smooth for smooth in found if smooth is not None)


def _along(axis: str, limits: tuple[float, float], rig: str | None = None) -> list[Smooth | None]:
    both = (False, True) if axis in RELATIVE_AXES else (False,)
    return [smooth_along({axis: limits}, rig, relative=relative) for relative in both]

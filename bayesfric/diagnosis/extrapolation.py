"""What a fit is extrapolated to: the end of a range, and the other rig."""

import numpy as np
from numpy.typing import NDArray

from bayesfric.diagnosis.residuals import Residuals

__all__ = ["extrapolated"]

NEAR = 0.8  # of the range of tension, from which on a trial is extrapolated to


def extrapolated(residuals: Residuals) -> dict[str, NDArray[np.bool_]]:
    """Return the windows of what lies at the end of a range, and of each rig.

    Parameters
    ----------
    residuals : Residuals
        Windows of both boards.

    Returns
    -------
    dict of str to ndarray of bool, shape (R,)
        Whole trials, by name; none that would leave a pulley size without windows.
    """
    found: dict[str, NDArray[np.bool_]] = {}
    where = residuals.covariates
    gravity = where["rig"] == 0
    if gravity.any():
        # Trials of one pair of masses differ in tension by what they accelerate.
        tension, pulleys, wrap = (where[axis] for axis in ("tension", "n_pulleys", "wrap_angle"))
        low, high = tension[gravity].min(), tension[gravity].max()
        found["top tension"] = gravity & (tension > low + NEAR * (high - low))
        # Means over a window: as equal as rounding lets them be.
        found["largest number of pulleys"] = np.isclose(pulleys, pulleys.max())
        found["extreme wrap angle"] = np.isclose(wrap, wrap.max())
    if gravity.any() and not gravity.all():
        found["the motor board, from the gravity board"] = ~gravity
        found["the gravity board, from the motor board"] = gravity
    sizes = [where["pulley_size"] == size for size in np.unique(where["pulley_size"])]
    return {
        name: rows
        for name, rows in found.items()
        if rows.any() and all((~rows & mine).any() for mine in sizes)
    }

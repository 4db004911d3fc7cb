"""Which way friction is counted in ``steady_friction.csv``.

People write the size of friction, or give it the sign of the speed, as a force that drives
has, or the opposite sign, as a force that resists has. A table is read by the convention that
leaves the fewest points pushing.
"""

import numpy as np
import pandas as pd

from bayesfric.arrays import Array, Flags

NOISE = 3.0  # standard errors, within which a point does not say that it pushes
SYSTEMATIC_SHARE = 0.25  # of rows: what is odd in more of them is a convention or a unit


def against_motion(table: pd.DataFrame) -> Array:
    """Return friction against the motion, shape (N,).

    Parameters
    ----------
    table : DataFrame
        N points with ``friction_n`` and, if there is one, ``velocity_m_s``, whose 0 is a point
        at the brink of motion: its friction counts by its size.

    Returns
    -------
    ndarray
        In the unit of the table; negative where a point pushes.
    """
    friction = table["friction_n"].to_numpy(dtype=np.float64)
    # Without a speed, a sign that changes only says which way it went.
    size = np.abs(friction)
    conventions: tuple[Array, ...] = (friction, -friction)
    if (friction < 0).mean() > SYSTEMATIC_SHARE and (friction > 0).mean() > SYSTEMATIC_SHARE:
        conventions = (size,)
    if "velocity_m_s" in table:
        way = np.sign(table["velocity_m_s"].to_numpy(dtype=np.float64))
        signed = way * friction
        conventions = (
            friction,
            *(np.where(way == 0, size, convention) for convention in (signed, -signed)),
        )
    return min(conventions, key=lambda convention: -np.minimum(convention, 0.0).sum()).copy()


def pushing(table: pd.DataFrame) -> Flags:
    """Return which points push, by more than their standard error allows, shape (N,)."""
    against = against_motion(table)
    if "friction_sd_n" in table:
        against += NOISE * table["friction_sd_n"].fillna(0.0).to_numpy(dtype=np.float64)
    return np.asarray(against < 0)


def notes_on_signs(table: pd.DataFrame) -> list[str]:
    """Return what a reader should know of points that push, and of points at rest."""
    notes = []
    if (push := pushing(table)).any():
        notes.append(
            f"run {', '.join(table.loc[push, 'run'])}: friction that pushes, kept as it is"
        )
    if "velocity_m_s" in table and (rest := table["velocity_m_s"] == 0).any():
        runs = ", ".join(table.loc[rest, "run"])
        notes.append(f"run {runs}: at no speed, taken as friction at the brink of motion")
    return notes

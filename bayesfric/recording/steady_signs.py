"""The sign convention of friction in ``steady_friction.csv``.

Friction may be given as an absolute value, with the sign of the speed (as a driving force has), or
with the opposite sign (as a resisting force has). A table is read by the convention under which the
fewest points drive the motion.
"""

import numpy as np
import pandas as pd

from bayesfric.arrays import Array, Flags

NOISE = 3.0  # standard errors within which a point does not count as driving
SYSTEMATIC_SHARE = 0.25  # share of odd rows above which the convention or a unit is wrong


def against_motion(table: pd.DataFrame) -> Array:
    """Return friction against the motion, shape (N,).

    Parameters
    ----------
    table : DataFrame
        N points with ``friction_n`` and, if there is one, ``velocity_m_s``. A speed of 0 is a
        point at breakaway, whose friction is taken as an absolute value.

    Returns
    -------
    ndarray
        In the unit of the table; negative if friction drives the motion.
    """
    friction = table["friction_n"].to_numpy(dtype=np.float64)
    # Without a speed, a changing sign only shows the direction of motion.
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
    """Return which points drive the motion beyond their standard error, shape (N,)."""
    against = against_motion(table)
    if "friction_sd_n" in table:
        against += NOISE * table["friction_sd_n"].fillna(0.0).to_numpy(dtype=np.float64)
    return np.asarray(against < 0)


def notes_on_signs(table: pd.DataFrame) -> list[str]:
    """Return notes on points that drive the motion, and on points at rest."""
    notes = []
    if (push := pushing(table)).any():
        notes.append(
            f"run {', '.join(table.loc[push, 'run'])}: friction that pushes, kept as it is"
        )
    if "velocity_m_s" in table and (rest := table["velocity_m_s"] == 0).any():
        runs = ", ".join(table.loc[rest, "run"])
        notes.append(f"run {runs}: at no speed, taken as friction at the brink of motion")
    return notes

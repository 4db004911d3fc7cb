"""Checks for measurements in which friction would drive the motion or a cable would push.

Noise, an outlier or an effect may cause this in single rows. If it happens in many rows, a unit, a
sign or a constant of the rig is wrong.
"""

import numpy as np
import pandas as pd

from bayesfric.errors import Fault
from bayesfric.recording.cells import Table
from bayesfric.recording.steady_signs import SYSTEMATIC_SHARE
from bayesfric.recording.tables import RigConstants

FRICTIONLESS = 1.25  # times the frictionless acceleration: more is no error of a sensor or clock
PUSHED = -0.1  # of the weight: allows for a slack cable and the noise of a current
HELD = 0.5  # of a raised weight: a smaller pull is no error of a torque constant
MASSES = ["mass_drive_kg", "mass_load_kg"]


def gains_energy(
    trials: Table, acceleration: "pd.Series[float]", rig: RigConstants, column: str
) -> list[Fault]:
    """Return the fault of trials that accelerate faster than two weights without friction.

    Without friction, the acceleration is ``g (m1 − m2) / (m1 + m2)``.

    Parameters
    ----------
    trials : Table
        ``gravity_trials.csv``.
    acceleration : Series of float
        Acceleration of some of its rows, by their index [m/s²].
    rig : RigConstants
        Local gravity.
    column : str
        Column of the fault.
    """
    if acceleration.empty or not trials.has(*MASSES):
        return []
    drive, load = (trials.frame.loc[acceleration.index, mass] for mass in MASSES)
    most = rig.gravity_m_s2 * (drive - load) / (drive + load)
    wrong = (most > 0) & (acceleration > FRICTIONLESS * most)
    if wrong.mean() <= SYSTEMATIC_SHARE:
        return []
    first = wrong.idxmax()
    expected = (
        f"masses that can drive this motion: it has {acceleration[first]:.3g} m/s², and "
        f"{most[first]:.3g} m/s² without any friction (are masses, times and the travel between "
        "two events right?)"
    )
    return trials.text.faults_at(acceleration.index[wrong].to_numpy(), column, expected, most=1)


def motor_pull(runs: Table, idle: Table, rig: RigConstants) -> "pd.Series[float] | None":
    """Return the force with which the motor pulls, ``k_t (I − I_idle(v)) / r`` [N].

    Parameters
    ----------
    runs, idle : Table
        ``motor_runs.csv`` and ``motor_idle.csv``.
    rig : RigConstants
        Torque constant and radius of the capstan.

    Returns
    -------
    Series of float or None
        The force, by the rows of `runs`; None if an input is missing.
    """
    needed = ["velocity_m_s", "current_a"]
    constant, radius = rig.motor_torque_constant_n_m_per_a, rig.capstan_radius_m
    if constant is None or radius is None or not (runs.has(*needed) and idle.has(*needed)):
        return None
    alone = idle.frame.dropna(subset=needed).groupby("velocity_m_s")["current_a"].mean()
    if alone.empty:
        return None
    without = np.interp(runs.frame["velocity_m_s"], alone.index, alone)
    pull: pd.Series[float] = (runs.frame["current_a"] - without) * constant / radius
    return pull


def pushes_a_cable(
    runs: Table, pull: "pd.Series[float]", weight: "pd.Series[float]"
) -> list[Fault]:
    """Return the fault of runs on which the motor would push its cable.

    Parameters
    ----------
    runs : Table
        ``motor_runs.csv``.
    pull, weight : Series of float
        By its rows [N].
    """
    return _where_many(
        runs,
        pull < PUSHED * weight,
        "current_a",
        "a current that pulls, with the sign of the torque that raises; beyond that of the motor "
        "alone this one pushes the cable (are its sign and the unit of motor_idle.csv right?)",
    )


def drops_the_weight(
    runs: Table, pull: "pd.Series[float]", weight: "pd.Series[float]"
) -> list[Fault]:
    """Return the fault of runs on which the motor raises a weight that it does not hold.

    Parameters
    ----------
    runs : Table
        ``motor_runs.csv``.
    pull, weight : Series of float
        By its rows [N].
    """
    raised = runs.frame["velocity_m_s"] > 0
    dropped = raised & (pull < HELD * weight)
    if dropped.sum() <= SYSTEMATIC_SHARE * raised.sum():
        return []
    expected = (
        "a current that holds the weight that it raises, beyond that of the motor alone (are it "
        "and the torque constant in A and N·m/A, and the radius in m?)"
    )
    return runs.first_where(dropped, "current_a", expected)


def tears_a_cable(points: Table) -> list[Fault]:
    """Return the fault of points with more friction than the tension of a cable allows.

    The tension is the mean of both ends and friction their difference: beyond twice the
    tension, one end would push.

    Parameters
    ----------
    points : Table
        ``steady_friction.csv`` of a cable over pulleys.
    """
    if not points.has("friction_n", "tension_n"):
        return []
    return _where_many(
        points,
        points.frame["friction_n"].abs() > 2 * points.frame["tension_n"],
        "friction_n",
        "friction of at most twice the tension: beyond that one end of the cable would push "
        "(is it in millinewtons or grams?)",
    )


def _where_many(table: Table, wrong: "pd.Series[bool]", column: str, expected: str) -> list[Fault]:
    """Return the fault of the first wrong row, if many rows are wrong."""
    if wrong.mean() <= SYSTEMATIC_SHARE:
        return []
    return table.first_where(wrong, column, expected)

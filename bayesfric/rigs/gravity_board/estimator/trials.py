"""Step 1 of the paper's estimator: the friction of each trial by least squares."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from bayesfric.physics.gravity import Condition, nominal_tension
from bayesfric.recording.tables import Gravity, RigConstants


@dataclass(frozen=True)
class TrialFriction:
    """Step 1 for one trial.

    Parameters
    ----------
    trial, pulley_size : str
        As recorded.
    n_pulleys : int
        Number of pulleys.
    wrap_angle_deg : float
        Average individual wrap angle [deg].
    tension_n : float or None
        Nominal tension at the acceleration that fc gives [N].
    friction_n : float or None
        fc [N].
    r_squared : float or None
        Of the trial's motion; None for an acceleration without events.
    reason : str or None
        Why there is no friction.
    """

    trial: str
    pulley_size: str
    n_pulleys: int
    wrap_angle_deg: float
    tension_n: float | None
    friction_n: float | None
    r_squared: float | None
    reason: str | None = None


def constant_friction(events: pd.DataFrame, condition: Condition) -> tuple[float, float]:
    """Fit fc, the start speed and an offset a sensor to the displacements of one trial.

    Parameters
    ----------
    events : DataFrame
        ``sensor``, ``displacement_m``, ``time_s`` of the trial; more events than
        numbers fitted.
    condition : Condition
        Masses and gravity of the trial, numbers.

    Returns
    -------
    friction : float
        fc of the motion of eq. (4) that fits best [N].
    r_squared : float
        1 − residual over total sum of squares of displacement, each sensor around
        its own mean.
    """
    time = events["time_s"].to_numpy()
    time = time - time.min()
    travel = events["displacement_m"].to_numpy()
    sensors, of_sensor = np.unique(events["sensor"].to_numpy(dtype=str), return_inverse=True)
    offsets = np.eye(sensors.size)[of_sensor]
    regressors = np.column_stack([time**2 / 2, time, offsets])
    (acceleration, speed, *shifts), *_ = np.linalg.lstsq(regressors, travel, rcond=None)
    mass, drive = float(condition.total_mass_kg), float(condition.drive_force_n)
    residual = regressors @ [acceleration, speed, *shifts] - travel
    around = travel - offsets @ ((offsets.T @ travel) / offsets.sum(axis=0))
    r_squared = 1 - residual @ residual / (around @ around)
    return float(drive - mass * acceleration), float(r_squared)


def trial_frictions(gravity: Gravity, rig: RigConstants) -> tuple[TrialFriction, ...]:
    """Return step 1: fc of each trial with eq. (4), or from its measured acceleration.

    Parameters
    ----------
    gravity : Gravity
        As recorded.
    rig : RigConstants
        For gravity.

    Returns
    -------
    tuple of TrialFriction
        In the order of the trials.
    """
    events = {str(trial): rows for trial, rows in gravity.events.groupby("trial", sort=False)}
    frictions = []
    for row in gravity.trials.to_dict("records"):
        condition = Condition(
            row["n_pulleys"],
            row["wrap_angle_deg"],
            row["mass_drive_kg"],
            row["mass_load_kg"],
            rig.gravity_m_s2,
        )
        mass, drive = float(condition.total_mass_kg), float(condition.drive_force_n)
        own = events.get(row["trial"])
        friction = r_squared = reason = None
        if own is not None and len(own) > 2 + own["sensor"].nunique():
            friction, r_squared = constant_friction(own, condition)
        elif np.isfinite(row.get("acceleration_m_s2", np.nan)):
            friction = drive - mass * float(row["acceleration_m_s2"])
        else:
            reason = "fewer events than numbers to fit, and no acceleration"
        tension = (
            None
            if friction is None
            else float(nominal_tension(condition, (drive - friction) / mass))
        )
        frictions.append(
            TrialFriction(
                trial=row["trial"],
                pulley_size=row["pulley_size"],
                n_pulleys=int(row["n_pulleys"]),
                wrap_angle_deg=float(row["wrap_angle_deg"]),
                tension_n=tension,
                friction_n=friction,
                r_squared=r_squared,
                reason=reason,
            )
        )
    return tuple(frictions)

"""Step 1 of the paper's estimator: the friction of each trial by least squares."""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.optimize import least_squares

from bayesfric.arrays import Array
from bayesfric.physics.compliant import Cable, compliant_motion
from bayesfric.physics.gravity import Condition, nominal_tension
from bayesfric.recording.tables import Gravity, RigConstants

__all__ = ["ConstantFriction", "TrialFriction", "fit_constant_friction", "trial_frictions"]


@dataclass(frozen=True)
class ConstantFriction:
    """A trial's motion with the one friction that fits it best.

    Parameters
    ----------
    friction_n : float
        fc [N].
    start_speed_m_s : float
        Speed at the trial's first event [m/s].
    start_stretch_m : float or None
        Stretch of the cable at the first event [m]; None with eq. (4).
    r_squared : float
        1 − residual over total sum of squares of displacement, each sensor around
        its own mean.
    """

    friction_n: float
    start_speed_m_s: float
    start_stretch_m: float | None
    r_squared: float


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


def fit_constant_friction(
    events: pd.DataFrame,
    condition: Condition,
    *,
    cable: Cable | None = None,
    free_stretch: bool = False,
) -> ConstantFriction:
    """Fit fc, the start speed and an offset a sensor to the displacements of one trial.

    Parameters
    ----------
    events : DataFrame
        ``sensor``, ``displacement_m``, ``time_s`` of the trial; more events than
        numbers fitted.
    condition : Condition
        Masses and gravity of the trial, numbers.
    cable : Cable or None
        With a cable the four-state model (3), started at the first event with equal
        speeds; None is eq. (4), linear in its parameters and solved as such.
    free_stretch : bool
        With a cable, fit the stretch at the first event too; else it is the static one.

    Returns
    -------
    ConstantFriction
        The least-squares motion.
    """
    time = events["time_s"].to_numpy() - events["time_s"].min()
    travel = events["displacement_m"].to_numpy()
    sensors, of_sensor = np.unique(events["sensor"].to_numpy(dtype=str), return_inverse=True)
    offsets = np.eye(sensors.size)[of_sensor]
    regressors = np.column_stack([time**2 / 2, time, offsets])
    (acceleration, speed, *shifts), *_ = np.linalg.lstsq(regressors, travel, rcond=None)
    mass, drive = float(condition.total_mass_kg), float(condition.drive_force_n)
    friction, stretch = drive - mass * acceleration, None
    residual = regressors @ [acceleration, speed, *shifts] - travel

    if cable is not None:
        static = float(compliant_motion(condition, 0.0, cable).start_stretch_m)
        at_drive = np.asarray(sensors == "drive")[of_sensor]

        def misfit(parameters: Array) -> Array:
            force, first_speed, *shift = parameters
            first_stretch = shift.pop() if free_stretch else static
            ends = compliant_motion(
                condition,
                force,
                cable,
                start_speed_m_s=first_speed,
                start_stretch_m=first_stretch,
            ).ends(time)
            position = np.where(at_drive, ends.drive_position_m, ends.load_position_m)
            return np.asarray(position + offsets @ shift - travel)

        start = np.array([friction, max(speed, 0.0), *shifts, *([static] if free_stretch else [])])
        lowest = np.full(start.size, -np.inf)
        lowest[1] = 0.0
        fit = least_squares(
            misfit, start, "3-point", (lowest, np.inf), x_scale="jac", xtol=1e-15, gtol=1e-15
        )
        friction, speed = fit.x[:2]
        residual, stretch = fit.fun, float(fit.x[-1]) if free_stretch else static
    around = travel - offsets @ ((offsets.T @ travel) / offsets.sum(axis=0))
    return ConstantFriction(
        float(friction), float(speed), stretch, float(1 - residual @ residual / (around @ around))
    )


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
            fit = fit_constant_friction(own, condition)
            friction, r_squared = fit.friction_n, fit.r_squared
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

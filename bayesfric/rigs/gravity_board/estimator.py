"""The paper's estimator: friction of each trial, then slopes, then slopes of slopes.

1. The friction fc of each trial is estimated by least squares on its motion, with eq. (4).
2. For each (size, n, θ), a straight line of fc against nominal tension is fitted.
3. At 85°, the slopes and the intercepts of these lines are fitted as proportional to n, eqs. (6)
   and (7). The results are c1 and c2.
4. For each n, a straight line of the slopes of step 2 against θ is fitted. The slopes of these
   lines are fitted as proportional to n, eqs. (9) to (11). The result is c3.

All fits are unweighted, and the results have no uncertainty. A quantity that the trials do not
determine is None, with the reason. Reports show the estimates next to the posterior.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pandas as pd

from bayesfric.arrays import Array
from bayesfric.physics.friction import REFERENCE_WRAP_ANGLE_DEG
from bayesfric.physics.gravity import Condition, nominal_tension
from bayesfric.recording.tables import Gravity, RigConstants
from bayesfric.rigs.gravity_board.trial_motion import trial_condition

LEAST_TENSION_RATIO = 1.1  # required ratio of the largest to the least tension of a line
LEAST_ANGLE_SPAN_DEG = 5.0  # required range of wrap angles of a line
ANGLE_TOLERANCE_DEG = 0.5  # of an angle that counts as 85°


@dataclass(frozen=True)
class TrialFriction:
    """The result of step 1 for one trial.

    Parameters
    ----------
    trial, pulley_size : str
        Recorded identifier and pulley size.
    n_pulleys : int
        Number of pulleys.
    wrap_angle_deg : float
        Average individual wrap angle [deg].
    tension_n : float or None
        Nominal tension at the acceleration that follows from fc [N].
    friction_n : float or None
        fc [N].
    r_squared : float or None
        R² of the trial's motion; None for an acceleration without events.
    reason : str or None
        Why there is no estimate of friction.
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
    """Fit fc, the first speed and an offset for each sensor to the displacements of one trial.

    Parameters
    ----------
    events : DataFrame
        ``sensor``, ``displacement_m`` and ``time_s`` of the trial; more events than fitted
        parameters.
    condition : Condition
        Masses and gravity of the trial, as numbers.

    Returns
    -------
    friction : float
        fc of the motion of eq. (4), by least squares [N].
    r_squared : float
        1 − residual over total sum of squares of the displacement. The total is taken around
        the mean of each sensor.
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
    """Return step 1: fc of each trial with eq. (4), from its events or its acceleration.

    Parameters
    ----------
    gravity : Gravity
        Trials and events.
    rig : RigConstants
        Constants of the board, for the acceleration of free fall.

    Returns
    -------
    tuple of TrialFriction
        Results in the order of the trials.
    """
    events = {str(trial): rows for trial, rows in gravity.events.groupby("trial", sort=False)}
    frictions = []
    for row in gravity.trials.to_dict("records"):
        condition = trial_condition(row, rig)
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


class Slope(NamedTuple):
    """A slope with its R², or the reason why there is none.

    Parameters
    ----------
    value : float or None
        The slope; the unit depends on its use.
    r_squared : float or None
        1 − residual over total sum of squares around the mean. It is negative if a constant
        fits better, and None if there are not more points than fitted parameters.
    reason : str or None
        Why there is no value.
    """

    value: float | None
    r_squared: float | None = None
    reason: str | None = None


@dataclass(frozen=True)
class CellLine:
    """The result of step 2 for one (size, n, θ): friction against tension.

    Parameters
    ----------
    n_pulleys : int
        Number of pulleys.
    wrap_angle_deg : float
        Average individual wrap angle [deg].
    trials : int
        Number of trials with an estimate of friction.
    slope : Slope
        dfc/dT [-].
    intercept_n : float or None
        fc at zero tension [N].
    """

    n_pulleys: int
    wrap_angle_deg: float
    trials: int
    slope: Slope
    intercept_n: float | None


@dataclass(frozen=True)
class SizeEstimate:
    """Coefficients of a pulley size, and the lines from which they follow.

    Parameters
    ----------
    pulley_size : str
        Recorded pulley size.
    cells : tuple of CellLine
        Lines of step 2, sorted by n and θ.
    c1, c2, c3 : Slope
        Coefficients [-], [N] and [1/deg].
    """

    pulley_size: str
    cells: tuple[CellLine, ...]
    c1: Slope
    c2: Slope
    c3: Slope


def lines_of_sizes(trials: Sequence[TrialFriction]) -> tuple[SizeEstimate, ...]:
    """Return steps 2 to 4 for each pulley size.

    Parameters
    ----------
    trials : sequence of TrialFriction
        Results of step 1.

    Returns
    -------
    tuple of SizeEstimate
        Results in the order in which the sizes appear.
    """
    return tuple(
        _size(size, [trial for trial in trials if trial.pulley_size == size])
        for size in dict.fromkeys(trial.pulley_size for trial in trials)
    )


def is_upright(wrap_angle_deg: float) -> bool:
    """Return whether a wrap angle counts as 85°, at which c1 and c2 are estimated."""
    return abs(wrap_angle_deg - REFERENCE_WRAP_ANGLE_DEG) <= ANGLE_TOLERANCE_DEG


def _size(size: str, trials: list[TrialFriction]) -> SizeEstimate:
    keys = sorted({(trial.n_pulleys, trial.wrap_angle_deg) for trial in trials})
    cells = tuple(
        _cell(*key, [trial for trial in trials if (trial.n_pulleys, trial.wrap_angle_deg) == key])
        for key in keys
    )
    lines = [cell for cell in cells if cell.slope.value is not None]
    upright = [cell for cell in lines if is_upright(cell.wrap_angle_deg)]
    counts = sorted({n for n, _ in keys})
    none = "no line of friction against tension at 85°"
    count = [cell.n_pulleys for cell in upright]
    return SizeEstimate(
        pulley_size=size,
        cells=cells,
        c1=_proportional(count, [cell.slope.value for cell in upright], none),
        c2=_proportional(count, [cell.intercept_n for cell in upright], none),
        c3=_proportional(
            counts,
            [_wrap_slope([cell for cell in lines if cell.n_pulleys == n]) for n in counts],
            "no number of pulleys was measured at two wrap angles",
        ),
    )


def _cell(n_pulleys: int, wrap_angle_deg: float, trials: list[TrialFriction]) -> CellLine:
    points = np.array(
        [(trial.tension_n, trial.friction_n) for trial in trials if trial.friction_n is not None]
    ).reshape(-1, 2)
    tension, friction = points.T
    count = len(points)
    if count < 2 or tension.max() < LEAST_TENSION_RATIO * tension.min():
        reason = (
            f"the tensions of its {count} trials differ by less than {LEAST_TENSION_RATIO - 1:.0%}"
        )
        return CellLine(n_pulleys, wrap_angle_deg, count, Slope(None, None, reason), None)
    slope, intercept = _line(tension, friction)
    return CellLine(n_pulleys, wrap_angle_deg, count, slope, intercept)


def _wrap_slope(cells: list[CellLine]) -> float | None:
    """Return d²fc/dT dθ of one number of pulleys; None if its wrap angles are alike [1/deg]."""
    angles = np.array([cell.wrap_angle_deg for cell in cells])
    if angles.size < 2 or np.ptp(angles) < LEAST_ANGLE_SPAN_DEG:
        return None
    slopes = np.array([cell.slope.value for cell in cells], dtype=np.float64)
    return float(least_squares_lines(angles, slopes)[0])


def least_squares_lines(x: Array, y: Array) -> tuple[Array, Array]:
    """Return slopes and intercepts of least-squares lines over the last axis."""
    apart = x - x.mean(axis=-1, keepdims=True)
    slope = (apart * y).sum(axis=-1) / (apart**2).sum(axis=-1)
    return slope, y.mean(axis=-1) - slope * x.mean(axis=-1)


def _line(x: Array, y: Array) -> tuple[Slope, float]:
    """Return slope and intercept of the least-squares line."""
    slope, intercept = map(float, least_squares_lines(x, y))
    return Slope(slope, _r_squared(y, slope * x + intercept, fitted=2)), intercept


def _proportional(n_pulleys: Sequence[int], values: Sequence[float | None], none: str) -> Slope:
    """Return the slope of the least-squares line through the origin; None values are ignored.

    `none` is the reason if there are no values.
    """
    defined = [(n, value) for n, value in zip(n_pulleys, values, strict=True) if value is not None]
    if not defined:
        return Slope(None, None, none)
    n, value = np.array(defined, dtype=np.float64).T
    slope = float(n @ value / (n @ n))
    return Slope(slope, _r_squared(value, slope * n, fitted=1))


def _r_squared(y: Array, fit: Array, *, fitted: int) -> float | None:
    total = float(((y - y.mean()) ** 2).sum())
    if y.size <= fitted or total == 0:
        return None
    return 1 - float(((y - fit) ** 2).sum()) / total


@dataclass(frozen=True)
class PaperEstimate:
    """Results of all steps.

    Parameters
    ----------
    trials : tuple of TrialFriction
        Results of step 1, in the order of the trials.
    sizes : tuple of SizeEstimate
        Results of steps 2 to 4, in the order in which the sizes appear.
    """

    trials: tuple[TrialFriction, ...]
    sizes: tuple[SizeEstimate, ...]


def estimate_as_the_paper(gravity: Gravity, rig: RigConstants) -> PaperEstimate:
    """Run the paper's estimator on the trials of a gravity board, with eq. (4).

    Parameters
    ----------
    gravity : Gravity
        Trials and events. The caller must exclude stalled trials.
    rig : RigConstants
        Constants of the board, for the acceleration of free fall.

    Returns
    -------
    PaperEstimate
        Results of all steps.
    """
    trials = trial_frictions(gravity, rig)
    return PaperEstimate(trials, lines_of_sizes(trials))

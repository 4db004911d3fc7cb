"""The delay of one sensor's clock, a nuisance parameter of each trial with a normal prior.

With an offset Δ between the clocks, the load sensor reads the displacement at a time Δ earlier.
This adds ∓ v/2 times Δ to the travel at a time stamp; the upper sign is that of the load sensor.
The column is scaled so that its coefficient has a prior of unit variance.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from bayesfric.arrays import Array
from bayesfric.inference.quadratic import LOG_2PI
from bayesfric.physics.cable import Cable
from bayesfric.recording.tables import RigConstants
from bayesfric.rigs.gravity_board.trial_motion import NUISANCES, Events

SHIFT = "clock_shift_s"
"""Column of the events: what was taken off a time to put both sensors on one clock [s]."""
PASSAGES = 2.0  # of a stretch along the cable, out and back: the standard deviation of an offset

CLOCK = NUISANCES
"""Place of the column among the regressors that are integrated out, after those of no prior."""
BESIDE = CLOCK + 1
FAR_BETTER = 25.0  # times the prior's precision, by which events tell the offset of each trial
RIDGE = 1e-12  # of a unit diagonal: columns that a trial does not have
LEAST_SD_M = 1e-9  # of an event: below it, as without noise, rounding is all that is left


@dataclass(frozen=True)
class ClockPrior:
    """The prior of the scaled number in N trials, and how it enters.

    Parameters
    ----------
    drawn : bool
        Whether the number stays in the form, to be integrated out at the noise of each walker.
    taken : bool
        Whether it is integrated out once, its prior as wide beside the noise as at `scale2`.
    moved : ndarray, shape (N,)
        From where the number is counted: its effect is taken off the residual.
    mean : ndarray, shape (N,)
        Of the number so counted.
    scale2 : float
        Variance of an event at which a prior that is taken once is exact [m²].
    share_of_events : ndarray, shape (N,)
        Share of the number that events tell, and not its prior; 0 where it is not taken once.
    constant : ndarray, shape (N,)
        What it adds to the log density.
    """

    drawn: bool
    taken: bool
    moved: Array
    mean: Array
    scale2: float
    share_of_events: Array
    constant: Array


def clock_sd_s(rig: RigConstants) -> float:
    """Return the standard deviation of the prior of an offset [s].

    As stated, or the time that a stretch takes along the cable and back, and half a step of
    the timer.
    """
    if rig.sensor_clock_sd_s is not None:
        return rig.sensor_clock_sd_s
    return PASSAGES * float(Cable().wave_time_s) + 0.5 * (rig.timer_resolution_s or 0.0)


def clock_shifts(events: pd.DataFrame, trial_ids: pd.Series) -> Array:
    """Return by how much the load sensor's times were moved, shape (N,) [s]."""
    if SHIFT not in events:
        return np.zeros(len(trial_ids))
    load = events[events["sensor"] == "load"]
    of_trial = load.groupby("trial", sort=False)[SHIFT].first()
    return of_trial.reindex(trial_ids).fillna(0.0).to_numpy(dtype=np.float64)


def none_late(count: int) -> ClockPrior:
    """Return what there is where no trial can show an offset."""
    none = np.zeros(count)
    return ClockPrior(False, False, none, none, 1.0, none, none)


def late_column(events: Events, speed_m_s: Array) -> Array:
    """Return what the load sensor's clock adds to the travel per second that it is late.

    Parameters
    ----------
    events : Events
        E of N trials.
    speed_m_s : ndarray, shape (E,)
        Of the cable.

    Returns
    -------
    ndarray, shape (E,)
        0 in trials of one sensor [m/s].
    """
    drive, load = (np.bincount(events.trial, seen)[events.trial] for seen in events.regressors[:2])
    sign = np.where(events.regressors[1] != 0, -0.5, 0.5)
    return np.asarray(np.where((drive != 0) & (load != 0), sign * speed_m_s, 0.0))


def clock_prior(events: Events, residual: Array, mean: Array) -> ClockPrior:
    """Return how the prior of the number enters.

    Parameters
    ----------
    events : Events
        Regressors are nuisances, the scaled column, what scatters, and τ²/2.
    residual : ndarray, shape (E,)
        Displacement less that of the pilot [m].
    mean : ndarray, shape (N,)
        Of the prior: times may have been moved already, by the opposite.
    """
    whole = events.normal_equations(np.ones((1, residual.size)), residual)[0]
    seen = whole[:, CLOCK, CLOCK] > 0
    whole[~seen, CLOCK, CLOCK] = 1.0
    scale2, precision = _noise(events, whole)
    if (precision[seen] < FAR_BETTER * scale2).any():
        none = np.zeros_like(mean)
        return ClockPrior(True, False, mean, none, scale2, none, none)
    alone = np.where(seen, 1 / np.linalg.inv(whole[:, :BESIDE, :BESIDE])[:, CLOCK, CLOCK], 0.0)
    share_of_events = alone / (scale2 + alone)
    # Counted from where it is likely, the number adds no square that grows with the noise.
    whole[:, CLOCK, CLOCK] += scale2
    whole[:, CLOCK, -1] += scale2 * mean
    size = np.sqrt(np.diagonal(whole, axis1=1, axis2=2))[:, :-1]
    size = np.where(size > 0, size, 1.0)
    gram = whole[:, :-1, :-1] / size[:, :, None] / size[:, None, :] + RIDGE * np.eye(size.shape[1])
    fit = np.linalg.solve(gram, (whole[:, :-1, -1] / size)[..., None])[..., 0] / size
    likely = np.where(seen, fit[:, CLOCK], mean)
    constant = 0.5 * np.log(scale2) * (1 - share_of_events) - 0.5 * share_of_events * LOG_2PI
    constant -= 0.5 * (mean - likely) ** 2
    return ClockPrior(False, True, likely, mean - likely, scale2, share_of_events, constant)


def _noise(events: Events, whole: Array) -> tuple[float, Array]:
    """Return the variance of an event by what all columns leave, and the column's precision.

    Parameters
    ----------
    events : Events
        Of N trials.
    whole : ndarray, shape (N, R + 1, R + 1)
        Products of the columns and the residual.

    Returns
    -------
    variance : float
        [m²]; infinite where no trial has events to spare.
    precision : ndarray, shape (N,)
        Of the number beside all other columns, times the variance [m²].
    """
    size = np.sqrt(np.diagonal(whole, axis1=1, axis2=2))
    size = np.where(size > 0, size, 1.0)
    unit = whole / size[:, :, None] / size[:, None, :]
    inverse = np.linalg.inv(unit[:, :-1, :-1] + RIDGE * np.eye(unit.shape[-1] - 1))
    left = 1 - (unit[:, -1:, :-1] @ inverse @ unit[:, :-1, -1:])[:, 0, 0]
    freedom = events.total(np.ones_like(events.tau)) - (unit.shape[-1] - 1)
    spare = freedom > 0
    if not spare.any():
        return np.inf, np.zeros(len(whole))
    square = (np.maximum(left, 0.0) * size[:, -1] ** 2)[spare].sum()
    variance = max(float(square / freedom[spare].sum()), LEAST_SD_M**2)
    return variance, size[:, CLOCK] ** 2 / inverse[:, CLOCK, CLOCK]

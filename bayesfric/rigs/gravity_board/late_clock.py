"""The delay of one sensor's clock, a nuisance parameter of each trial with a normal prior.

If the load sensor's clock is late by Δ, the true time of its events is Δ earlier than the recorded
one. The offset is split evenly between the sensors: at a recorded time, the travel seen by the
load sensor is smaller by Δ v/2, and that seen by the drive sensor is larger by Δ v/2. The
regressor of the offset is scaled so that its coefficient has a prior of unit variance.
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
"""Column of the event table: time that was subtracted to put both sensors on one clock [s]."""
PASSAGES = 2.0  # default sd of an offset, in passages of a stretch along the cable: out and back

CLOCK = NUISANCES
"""Index of the offset among the regressors, after the nuisances with a flat prior."""
NUISANCES_WITH_CLOCK = CLOCK + 1
FAR_BETTER = 25.0  # required precision of the offset by each trial's events, over the prior's
RIDGE = 1e-12  # added to a unit diagonal, for columns that are zero in a trial
LEAST_SD_M = 1e-9  # of an event: smaller residuals, as of data without noise, are rounding errors


@dataclass(frozen=True)
class ClockPrior:
    """The prior of the scaled offset in N trials, and the way in which it is integrated out.

    Parameters
    ----------
    in_form : bool
        Whether the offset is a variable of the form, integrated out at the noise of each walker.
    integrated_once : bool
        Whether it is integrated out once. Its prior then has the same width relative to the
        noise at any noise. If neither `in_form` nor `integrated_once` is true, there is no offset.
    centre : ndarray, shape (N,)
        Value at which the residual is taken: the response to it is subtracted.
    mean : ndarray, shape (N,)
        Prior mean of the offset minus `centre`.
    scale2 : float
        Variance of an event at which integrating out once is exact [m²].
    event_share : ndarray, shape (N,)
        Share of the information on the offset that comes from the events, not from the prior;
        0 if it is not integrated out once.
    constant : ndarray, shape (N,)
        Constant term of the log density.
    """

    in_form: bool
    integrated_once: bool
    centre: Array
    mean: Array
    scale2: float
    event_share: Array
    constant: Array


def clock_sd_s(rig: RigConstants) -> float:
    """Return the prior standard deviation of an offset [s].

    The default is the time that a stretch takes along the cable and back, plus half a step of the
    timer.
    """
    if rig.sensor_clock_sd_s is not None:
        return rig.sensor_clock_sd_s
    return PASSAGES * float(Cable().wave_time_s) + 0.5 * (rig.timer_resolution_s or 0.0)


def clock_shifts(events: pd.DataFrame, trial_ids: pd.Series) -> Array:
    """Return the time that was subtracted from the load sensor's times, shape (N,) [s]."""
    if SHIFT not in events:
        return np.zeros(len(trial_ids))
    load = events[events["sensor"] == "load"]
    of_trial = load.groupby("trial", sort=False)[SHIFT].first()
    return of_trial.reindex(trial_ids).fillna(0.0).to_numpy(dtype=np.float64)


def none_late(count: int) -> ClockPrior:
    """Return the prior for N = `count` trials without an offset."""
    none = np.zeros(count)
    return ClockPrior(False, False, none, none, 1.0, none, none)


def late_column(events: Events, speed_m_s: Array) -> Array:
    """Return the response of the travel to a delay of the load sensor's clock, per second.

    Parameters
    ----------
    events : Events
        E events of N trials.
    speed_m_s : ndarray, shape (E,)
        Speed of the cable [m/s].

    Returns
    -------
    ndarray, shape (E,)
        Response [m/s]; 0 in trials that only one sensor recorded.
    """
    drive, load = (np.bincount(events.trial, seen)[events.trial] for seen in events.regressors[:2])
    sign = np.where(events.regressors[1] != 0, -0.5, 0.5)
    return np.asarray(np.where((drive != 0) & (load != 0), sign * speed_m_s, 0.0))


def clock_prior(events: Events, residual: Array, mean: Array) -> ClockPrior:
    """Return the prior of the scaled offset, and whether it can be integrated out once.

    Parameters
    ----------
    events : Events
        Events with the regressors of nuisances, the scaled offset, scatter, and τ²/2.
    residual : ndarray, shape (E,)
        Displacement minus that of the pilot fit [m].
    mean : ndarray, shape (N,)
        Prior mean. It is not 0 if the times were shifted beforehand.
    """
    whole = events.normal_equations(np.ones((1, residual.size)), residual)[0]
    seen = whole[:, CLOCK, CLOCK] > 0
    whole[~seen, CLOCK, CLOCK] = 1.0
    scale2, precision = _noise(events, whole)
    if (precision[seen] < FAR_BETTER * scale2).any():
        none = np.zeros_like(mean)
        return ClockPrior(True, False, mean, none, scale2, none, none)
    nuisances = whole[:, :NUISANCES_WITH_CLOCK, :NUISANCES_WITH_CLOCK]
    alone = np.where(seen, 1 / np.linalg.inv(nuisances)[:, CLOCK, CLOCK], 0.0)
    event_share = alone / (scale2 + alone)
    # With the most likely offset subtracted, the prior adds no square that depends on the noise.
    whole[:, CLOCK, CLOCK] += scale2
    whole[:, CLOCK, -1] += scale2 * mean
    unit, size = to_unit_diagonal(whole[:, :-1, :-1])
    gram = unit + RIDGE * np.eye(size.shape[1])
    fit = np.linalg.solve(gram, (whole[:, :-1, -1] / size)[..., None])[..., 0] / size
    likely = np.where(seen, fit[:, CLOCK], mean)
    constant = 0.5 * np.log(scale2) * (1 - event_share) - 0.5 * event_share * LOG_2PI
    constant -= 0.5 * (mean - likely) ** 2
    return ClockPrior(False, True, likely, mean - likely, scale2, event_share, constant)


def to_unit_diagonal(gram: Array) -> tuple[Array, Array]:
    """Return matrices scaled to a unit diagonal, (N, R, R), and the scales, (N, R).

    The scale of a column of zeros is 1.
    """
    size = np.sqrt(np.diagonal(gram, axis1=1, axis2=2))
    size = np.where(size > 0, size, 1.0)
    return np.asarray(gram / size[:, :, None] / size[:, None, :]), size


def _noise(events: Events, whole: Array) -> tuple[float, Array]:
    """Return the residual variance of an event, and the precision of the offset.

    Parameters
    ----------
    events : Events
        Of N trials.
    whole : ndarray, shape (N, R + 1, R + 1)
        Sums of products of the R columns and the residual.

    Returns
    -------
    variance : float
        Variance [m²]; infinite if no trial has more events than columns.
    precision : ndarray, shape (N,)
        Precision of the scaled offset, given unknown coefficients of all other columns, times
        the variance of an event [m²].
    """
    unit, size = to_unit_diagonal(whole)
    inverse = np.linalg.inv(unit[:, :-1, :-1] + RIDGE * np.eye(unit.shape[-1] - 1))
    left = 1 - (unit[:, -1:, :-1] @ inverse @ unit[:, :-1, -1:])[:, 0, 0]
    freedom = events.total(np.ones_like(events.tau)) - (unit.shape[-1] - 1)
    spare = freedom > 0
    if not spare.any():
        return np.inf, np.zeros(len(whole))
    square = (np.maximum(left, 0.0) * size[:, -1] ** 2)[spare].sum()
    variance = max(float(square / freedom[spare].sum()), LEAST_SD_M**2)
    return variance, size[:, CLOCK] ** 2 / inverse[:, CLOCK, CLOCK]

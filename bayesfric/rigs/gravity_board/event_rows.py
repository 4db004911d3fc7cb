"""Rows of the gravity board in the linear model: events, accelerations, and their variances."""

from dataclasses import replace

import numpy as np
import pandas as pd

from bayesfric.arrays import Array, Flags
from bayesfric.rigs.gravity_board.measurements import optional_column
from bayesfric.rigs.gravity_board.trial_motion import Events

ROUGH_SD = 0.01  # m/s², assumed for an acceleration without a standard error
LEAST_SD_M = 1e-7  # of an event: smaller residuals, as of data without noise, are rounding errors
ROUGH = 9.0  # mean square residual over variance: beyond it, no smooth path fits the trial


def with_accelerations(
    trials: pd.DataFrame, events: Events, duration_s: Array
) -> tuple[Events, Flags, Array]:
    """Add a row for each trial without events: the travel from rest at its acceleration.

    Parameters
    ----------
    trials : DataFrame
        The N trials.
    events : Events
        Events of the trials that have some.
    duration_s : ndarray, shape (N,)
        Duration of each trial [s].

    Returns
    -------
    rows : Events
        E rows, sorted by trial.
    without_events : ndarray of bool, shape (E,)
        Which rows are those of trials with only an acceleration.
    sd : ndarray, shape (N,)
        Standard error of each trial's acceleration [m/s²].
    """
    added = np.flatnonzero(~np.isin(np.arange(len(trials)), events.trial))
    duration = duration_s[added]
    travel = optional_column(trials, "acceleration_m_s2")[added] * duration**2 / 2
    trial = np.concatenate([events.trial, added])
    order = np.argsort(trial, kind="stable")
    regressors = np.hstack([events.regressors, np.zeros((4, added.size))])[:, order]
    rows = replace(
        events,
        trial=trial[order],
        tau=np.concatenate([events.tau, duration])[order],
        displacement=np.concatenate([events.displacement, travel])[order],
        regressors=regressors,
        starts=np.flatnonzero(np.diff(trial[order], prepend=-1)),
    )
    sd = optional_column(trials, "acceleration_sd_m_s2")
    return rows, np.isin(rows.trial, added), np.where(np.isfinite(sd), sd, ROUGH_SD)


def variance_of(
    rows: Events, residual: Array, speed2: Array, without_events: Flags, stated_sd: Array
) -> Array:
    """Return the variance of each row, from residuals of the trials' smooth motions [m²].

    Parameters
    ----------
    rows : Events
        E rows.
    residual : ndarray
        Residuals of the rows that are events, from the smooth motions [m].
    speed2 : ndarray, shape (E,)
        Squared speed [m²/s²].
    without_events, stated_sd : ndarray
        Results `without_events` and `sd` of :func:`with_accelerations`.
    """
    travel = rows.tau**2 / 2
    stated = (stated_sd[rows.trial] * travel) ** 2
    if without_events.all():
        return np.asarray(stated)
    square = np.zeros_like(speed2)
    square[~without_events] = residual**2
    slope, level = np.polyfit(speed2[~without_events], square[~without_events], 1)
    # Neither variance, of position or of the clock, may be negative.
    if level < 0:
        level, slope = 0.0, square[~without_events].mean() / speed2[~without_events].mean()
    elif slope < 0:
        level, slope = square[~without_events].mean(), 0.0
    variance = level + slope * speed2
    for own in rows.rows_of_trials():
        # If no smooth path fits a trial, as when the cable nearly stops, the response to a force
        # is not known. The trial then has less weight.
        beyond = square[own].mean() / variance[own].mean()
        variance[own] *= beyond if beyond > ROUGH else 1.0
    return np.where(without_events, stated, np.maximum(variance, LEAST_SD_M**2))

"""Rows of the linear gravity board: its events, accelerations beside them, and their noise."""

from dataclasses import replace

import numpy as np
import pandas as pd

from bayesfric.arrays import Array, Flags
from bayesfric.rigs.gravity_board.measurements import optional_column
from bayesfric.rigs.gravity_board.trial_motion import Events

ROUGH_SD = 0.01  # m/s², of an acceleration that comes without its standard error
LEAST_SD_M = 1e-7  # of an event: below it, as without noise, rounding is all that is left
ROUGH = 9.0  # times the noise: squared, what no smooth path follows


def with_accelerations(
    trials: pd.DataFrame, events: Events, duration_s: Array
) -> tuple[Events, Flags, Array]:
    """Add a row for each trial without events: the travel from rest at its acceleration.

    Parameters
    ----------
    trials : DataFrame
        The N trials.
    events : Events
        Of those that have some.
    duration_s : ndarray, shape (N,)
        Of each trial [s].

    Returns
    -------
    rows : Events
        E rows, sorted by trial.
    alone : ndarray of bool, shape (E,)
        Which of them are of an acceleration alone.
    sd : ndarray, shape (N,)
        Standard error of each trial's acceleration [m/s²].
    """
    alone = np.flatnonzero(~np.isin(np.arange(len(trials)), events.trial))
    duration = duration_s[alone]
    travel = optional_column(trials, "acceleration_m_s2")[alone] * duration**2 / 2
    trial = np.concatenate([events.trial, alone])
    order = np.argsort(trial, kind="stable")
    regressors = np.hstack([events.regressors, np.zeros((4, alone.size))])[:, order]
    rows = replace(
        events,
        trial=trial[order],
        tau=np.concatenate([events.tau, duration])[order],
        displacement=np.concatenate([events.displacement, travel])[order],
        regressors=regressors,
        starts=np.flatnonzero(np.diff(trial[order], prepend=-1)),
    )
    sd = optional_column(trials, "acceleration_sd_m_s2")
    return rows, np.isin(rows.trial, alone), np.where(np.isfinite(sd), sd, ROUGH_SD)


def variance_of(rows: Events, rough: Array, speed2: Array, alone: Flags, stated_sd: Array) -> Array:
    """Return the variance of each row by residuals from each trial's smooth motion [m²].

    Parameters
    ----------
    rows : Events
        E rows.
    rough : ndarray
        Residuals from the smooth motions, of the rows of events [m].
    speed2 : ndarray, shape (E,)
        Squared speed [m²/s²].
    alone, stated_sd : ndarray
        As :func:`with_accelerations` returns them.
    """
    travel = rows.tau**2 / 2
    stated = (stated_sd[rows.trial] * travel) ** 2
    if alone.all():
        return np.asarray(stated)
    square = np.zeros_like(speed2)
    square[~alone] = rough**2
    slope, level = np.polyfit(speed2[~alone], square[~alone], 1)
    # Neither part of the noise is negative.
    if level < 0:
        level, slope = 0.0, square[~alone].mean() / speed2[~alone].mean()
    elif slope < 0:
        level, slope = square[~alone].mean(), 0.0
    variance = level + slope * speed2
    for own in rows.rows_of_trials():
        # Where no smooth path follows a trial, as where the cable all but stops, what a
        # force does along it is not known: the trial counts by so much less.
        beyond = square[own].mean() / variance[own].mean()
        variance[own] *= beyond if beyond > ROUGH else 1.0
    return np.where(alone, stated, np.maximum(variance, LEAST_SD_M**2))

"""How late one sensor's clock is, as a nuisance of each trial with a normal prior.

An offset Δ between the clocks lets the load sensor read the displacement of Δ ago. To the travel
at a stamped time that adds the column ∓ v/2 times Δ, the upper sign the load sensor's. The column
is scaled so that the prior of its number is of unit variance.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from bayesfric.arrays import Array
from bayesfric.physics.cable import Cable
from bayesfric.recording.tables import RigConstants
from bayesfric.rigs.gravity_board.trial_motion import NUISANCES, Events

__all__ = [
    "CLOCK",
    "SHIFT",
    "ClockPrior",
    "clock_prior",
    "clock_sd_s",
    "clock_shifts",
    "late_column",
    "none_late",
]

SHIFT = "clock_shift_s"
"""Column of the events: what was taken off a time to put both sensors on one clock [s]."""
PASSAGES = 2.0  # of a stretch along the cable, out and back: the standard deviation of an offset

CLOCK = NUISANCES
"""Place of the column among the regressors that are integrated out, after those of no prior."""
FAR_BETTER = 25.0  # times the prior's precision, by which events tell the offset of each trial
RIDGE = 1e-12  # of a unit diagonal: columns that a trial does not have
LEAST_SD_M = 1e-9  # of an event: below it, as without noise, rounding is all that is left
LOG_2PI = float(np.log(2 * np.pi))


@dataclass(frozen=True)
class ClockPrior:
    """The prior of the scaled number in N trials, and how it enters.

    Parameters
    ----------
    drawn : bool
        Whether the number stays in the form, to be integrated out at the noise of each walker.
    taken : bool
        Whether it is integrated out once, its prior as wide beside the noise as at `scale2`.
    mean : ndarray, shape (N,)
        Of the number: times were moved already by the opposite.
    scale2 : float
        Variance of an event at which a prior that is taken once is exact [m²].
    told : ndarray, shape (N,)
        Share of the number that events tell, and not its prior; 0 where it is not taken once.
    constant : ndarray, shape (N,)
        What it adds to the log density.
    """

    drawn: bool
    taken: bool
    mean: Array
    scale2: float
    told: Array
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
    return ClockPrior(False, False, none, 1.0, none, none)


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
        Of the prior.
    """
    whole = events.normal_equations(np.ones((1, residual.size)), residual)[0]
    size = np.sqrt(np.diagonal(whole, axis1=1, axis2=2))
    size = np.where(size > 0, size, 1.0)
    unit = whole / size[:, :, None] / size[:, None, :]
    gram = unit[:, :-1, :-1] + RIDGE * np.eye(unit.shape[-1] - 1)
    inverse = np.linalg.inv(gram)
    left = 1 - (unit[:, -1:, :-1] @ inverse @ unit[:, :-1, -1:])[:, 0, 0]
    freedom = np.maximum(events.total(np.ones_like(residual)) - gram.shape[-1], 0.0)
    square = np.maximum(left, 0.0) * size[:, -1] ** 2
    scale2 = float(square[freedom > 0].sum() / max(freedom.sum(), 1.0))
    scale2 = max(scale2, LEAST_SD_M**2)
    seen = whole[:, CLOCK, CLOCK] > 0
    precision = size[:, CLOCK] ** 2 / inverse[:, CLOCK, CLOCK]
    if not freedom.any() or (precision[seen] < FAR_BETTER * scale2).any():
        return ClockPrior(True, False, mean, scale2, np.zeros_like(mean), np.zeros_like(mean))
    whole[~seen, CLOCK, CLOCK] = 1.0
    together = np.linalg.inv(whole[:, : CLOCK + 1, : CLOCK + 1])
    alone = np.where(seen, 1 / together[:, CLOCK, CLOCK], 0.0)
    told = alone / (scale2 + alone)
    constant = 0.5 * np.log(scale2) * (1 - told) - 0.5 * told * LOG_2PI - 0.5 * mean**2
    return ClockPrior(False, True, mean, scale2, told, constant)

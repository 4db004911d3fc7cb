"""The measured motion of a trial, followed closely enough for forces that come and go.

A spline in time, whose pieces know nothing of each other beyond their joints: a spot at
which the cable rubs does not disturb the release.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline

from bayesfric.likelihood.hall_events import Events
from bayesfric.likelihood.paths import LEAST_SPEED_SHARE, POINTS, Paths

__all__ = ["follow", "travel_before"]

Array = NDArray[np.float64]
DEGREE = 4
PIECES, EVENTS_A_PIECE = 8, 10  # at most; at least, of both sensors
FIRST_SHARE = 32  # of a path is this one over, over which the release is followed back
LEAST_ACCELERATION = 0.02  # m/s², of a cable that is said to be released from rest


def follow(paths: Paths, events: Events) -> tuple[Paths, Array]:
    """Smooth the motion of each trial that has events.

    Parameters
    ----------
    paths : Paths
        Of N trials; those without events stay.
    events : Events
        Of the trials that have some, by their place among the N.

    Returns
    -------
    paths : Paths
        On the same grids.
    residual : ndarray, shape (E,)
        What the spline leaves of each event, as large as its error is [m].
    """
    speed, acceleration = paths.speed_m_s.copy(), paths.acceleration_m_s2.copy()
    residual = np.zeros(events.tau.size)
    grid = np.linspace(0, 1, POINTS)
    ends = np.append(events.starts[1:], events.tau.size)
    for start, end in zip(events.starts, ends, strict=True):
        rows = slice(start, end)
        tau, trial = events.tau[rows], int(events.trial[start])
        pieces = min(PIECES, max(1, tau.size // EVENTS_A_PIECE))
        knots = np.concatenate([np.zeros(DEGREE), np.linspace(0, 1, pieces + 1), np.ones(DEGREE)])
        sensors = events.regressors[:2, rows]
        basis = BSpline.design_matrix(np.clip(tau / tau.max(), 0, 1), knots, DEGREE).toarray()
        # One function less: the offsets of the sensors make the constant.
        design = np.hstack([sensors[(sensors != 0).any(axis=1)].T, basis[:, 1:]])
        fit = np.linalg.lstsq(design, events.displacement[rows], rcond=None)[0]
        freedom = max(tau.size - design.shape[1], 1)
        left = events.displacement[rows] - design @ fit
        residual[rows] = left * np.sqrt(tau.size / freedom)
        spline = BSpline(knots, np.append(0.0, fit[-(basis.shape[1] - 1) :]), DEGREE)
        speed[trial] = spline.derivative()(grid) / tau.max()
        acceleration[trial] = spline.derivative(2)(grid) / tau.max() ** 2
        speed[trial] = np.maximum(speed[trial], LEAST_SPEED_SHARE * speed[trial].max())
    return Paths(paths.step_s, speed, acceleration), residual


def travel_before(paths: Paths) -> Array:
    """Return the travel from the release to the first event, shape (N,) [m].

    From rest at the acceleration of the path's first part, ``v²/2a``.
    """
    speed, step = paths.speed_m_s, paths.step_s[:, 0]
    part = POINTS // FIRST_SHARE
    travelled = step * 0.5 * (speed[:, 1 : part + 1] + speed[:, :part]).sum(axis=1)
    gained = speed[:, part] ** 2 - speed[:, 0] ** 2
    moving = travelled > 0
    rate = gained / (2 * np.where(moving, travelled, 1.0))
    rate = np.maximum(np.where(moving, rate, 0.0), LEAST_ACCELERATION)
    return np.asarray(speed[:, 0] ** 2 / (2 * rate))

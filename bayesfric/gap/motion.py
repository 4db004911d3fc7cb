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
PIECES, EVENTS_A_PIECE = 8, 7  # at most; at least
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
        trial, duration = int(events.trial[start]), float(events.tau[start:end].max())
        followed = False
        # Each sensor by itself, lest one that slips disturbs the motion; the drive end's first.
        for sensor in events.regressors[:2, start:end]:
            rows = start + np.flatnonzero(sensor)
            if not rows.size:
                continue
            spline, left = _fit(events.tau[rows] / duration, events.displacement[rows])
            residual[rows] = left
            if not followed:
                speed[trial] = spline.derivative()(grid) / duration
                acceleration[trial] = spline.derivative(2)(grid) / duration**2
                followed = True
        speed[trial] = np.maximum(speed[trial], LEAST_SPEED_SHARE * speed[trial].max())
    return Paths(paths.step_s, speed, acceleration), residual


def _fit(place: Array, displacement: Array) -> tuple[BSpline, Array]:
    """Return a spline over 0 to 1 and its residuals, as large as the errors are."""
    pieces = min(PIECES, max(1, place.size // EVENTS_A_PIECE))
    # The joints span the events themselves; the ends are carried on.
    low, high = float(place.min()), float(place.max())
    inner = np.linspace(low, high, pieces + 1)
    knots = np.concatenate([np.full(DEGREE, low), inner, np.full(DEGREE, high)])
    degree = min(DEGREE, place.size - 2)
    if degree < DEGREE:
        knots = np.concatenate([np.full(degree + 1, low), np.full(degree + 1, high)])
    basis = BSpline.design_matrix(place, knots, degree).toarray()
    fit = np.linalg.lstsq(basis, displacement, rcond=None)[0]
    freedom = max(place.size - basis.shape[1], 1)
    left = (displacement - basis @ fit) * np.sqrt(place.size / freedom)
    return BSpline(knots, fit, degree, extrapolate=True), left


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

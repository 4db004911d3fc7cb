"""The measured motion of a trial, with enough resolution for local forces.

It is a spline in time. Because its pieces are coupled only at the knots, a local force, such as
that of a spot at which the cable rubs, does not change the estimated motion at the release.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import scipy

from bayesfric.arrays import Array
from bayesfric.recording.tables import Gravity, RigConstants
from bayesfric.rigs.gravity_board.paths import LEAST_SPEED_SHARE, POINTS, Paths, trial_paths
from bayesfric.rigs.gravity_board.trial_motion import Events, prepare_events

DEGREE = 4
PIECES, EVENTS_A_PIECE = 8, 7  # largest number of pieces; least number of events in each
STAGES, CORRECTIONS = 33, 6  # grid and iterations of the motion from rest to a speed
LEAST_ACCELERATION = 0.02  # m/s², lower bound in a motion from rest


class MeasuredMotion(NamedTuple):
    """The measured motion of N trials, independent of any law.

    Parameters
    ----------
    paths : Paths
        Motion by splines through the events.
    residual : ndarray, shape (E,)
        Residual of each event from its spline [m].
    events : Events
        Events, sorted by trial.
    """

    paths: Paths
    residual: Array
    events: Events


def measured_motion(gravity: Gravity, rig: RigConstants) -> MeasuredMotion:
    """Return the measured motion of each trial."""
    events = prepare_events(gravity.events, gravity.trials["trial"])
    return MeasuredMotion(*_fit_motions(trial_paths(gravity, rig), events), events)


def _fit_motions(paths: Paths, events: Events) -> tuple[Paths, Array]:
    """Fit a spline to the motion of each trial that has events.

    Parameters
    ----------
    paths : Paths
        Paths of N trials; those of trials without events are kept.
    events : Events
        Events, with the index of their trial among the N.

    Returns
    -------
    paths : Paths
        Motion of the splines on the same grids.
    residual : ndarray, shape (E,)
        Residual of each event from a spline, scaled to the size of the event's error [m].
    """
    speed, acceleration = paths.speed_m_s.copy(), paths.acceleration_m_s2.copy()
    residual = np.zeros(events.tau.size)
    if not events.tau.size:
        return paths, residual
    grid = np.linspace(0, 1, POINTS)
    for of_trial in events.rows_of_trials():
        trial, duration = int(events.trial[of_trial.start]), float(events.tau[of_trial].max())
        place, displacement = events.tau[of_trial] / duration, events.displacement[of_trial]
        sensors = events.of_sensors[:, of_trial]
        # Residuals are from a spline for each sensor, so that slip at one of them has no influence.
        for rows in sensors:
            if rows.any():
                left = _fit_spline(place[rows], displacement[rows])[1]
                residual[of_trial][rows] = left
        # The motion is a common spline; the second sensor may have an offset and a relative error.
        both = sensors.any(axis=1).all()
        apart = [sensors[1] * column for column in (1.0, displacement)] if both else []
        spline, _ = _fit_spline(place, displacement, apart)
        speed[trial] = spline.derivative()(grid) / duration
        acceleration[trial] = spline.derivative(2)(grid) / duration**2
        speed[trial] = np.maximum(speed[trial], LEAST_SPEED_SHARE * speed[trial].max())
    return Paths(paths.step_s, speed, acceleration), residual


def _fit_spline(
    place: Array, displacement: Array, apart: Sequence[Array] = ()
) -> "tuple[scipy.interpolate.BSpline, Array]":
    """Return a spline over 0 to 1, and its residuals scaled to the size of the errors."""
    pieces = min(PIECES, max(1, place.size // EVENTS_A_PIECE))
    # The knots span the events; beyond them the spline is extrapolated.
    low, high = float(place.min()), float(place.max())
    inner = np.linspace(low, high, pieces + 1)
    knots = np.concatenate([np.full(DEGREE, low), inner, np.full(DEGREE, high)])
    degree = min(DEGREE, place.size - 2)
    if degree < DEGREE:
        knots = np.concatenate([np.full(degree + 1, low), np.full(degree + 1, high)])
    basis = scipy.interpolate.BSpline.design_matrix(place, knots, degree).toarray()
    count = basis.shape[1]
    basis = np.column_stack([basis, *apart])
    fit = np.linalg.lstsq(basis, displacement, rcond=None)[0]
    freedom = max(place.size - basis.shape[1], 1)
    left = (displacement - basis @ fit) * np.sqrt(place.size / freedom)
    return scipy.interpolate.BSpline(knots, fit[:count], degree, extrapolate=True), left


def travel_to_speed(speed_m_s: Array, acceleration: Callable[[Array, Array], Array]) -> Array:
    """Return the travel from rest at which speeds are reached, shape (N,) [m].

    Parameters
    ----------
    speed_m_s : ndarray, shape (N,)
        The speeds [m/s].
    acceleration : callable
        Function of travel [m] and speed [m/s], both (N, S), that returns accelerations (N, S)
        [m/s²].
    """
    share = np.linspace(0, 1, STAGES)
    speed = speed_m_s[:, None] * share
    rate = np.maximum(acceleration(0 * speed, speed_m_s[:, None] + 0 * speed), LEAST_ACCELERATION)
    travel = speed**2 / (2 * rate[:, :1])
    for _ in range(CORRECTIONS):
        # d(v²)/dx = 2a, so that dx = v dv / a.
        rate = np.maximum(acceleration(travel, speed), LEAST_ACCELERATION)
        travel = speed_m_s[:, None] * scipy.integrate.cumulative_simpson(
            speed / rate, x=share, axis=1, initial=0
        )
    return np.asarray(travel[:, -1])

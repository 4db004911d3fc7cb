"""The smoothed motion of a trial, and the response of its travel to a force along it.

An effect that changes during a trial adds an acceleration h(τ), and so ``u(τ) = ∫∫ h dτ² `` to the
travel. This response is linear in the amplitude of the effect. h is evaluated along the measured
path, smoothed by a polynomial in time. The speed of this path is known to about 1e-3 whatever the
friction is, so the response does not depend on parameters.

This approximation neglects that a deviation of the first speed or of friction changes the force
along the path. Compared with a dense normal density for the exact motion, the log density of a
trial changes by about 0.01 nat if friction changes by 2 %, and by 0.6 nat of hundreds if it changes
by 10 %. A trial with only an acceleration is assumed to move from rest over the travel of the rig.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
import scipy
from numpy.polynomial import legendre
from scipy.sparse import csr_array

from bayesfric.arrays import Array, Whole
from bayesfric.effects import Effect
from bayesfric.physics.gravity import TRAVEL_M
from bayesfric.recording.frames import stands_in
from bayesfric.recording.tables import Gravity, RigConstants
from bayesfric.rigs.base import Unsupported
from bayesfric.rigs.gravity_board.trial_motion import Events, prepare_events

ROWS_AT_ONCE = 4096  # rows whose columns are computed together: all would need too much memory
POINTS = 129  # times of the grid of a path; odd, for Simpson's rule


@dataclass(frozen=True)
class DoubleIntegral:
    """The map from accelerations along paths to displacements at rows.

    Parameters
    ----------
    trial : ndarray of int, shape (E,)
        Trial of each row, ascending.
    place : ndarray, shape (E,)
        Time of each row on the grid of its trial, in steps of the grid.
    step_s : ndarray, shape (E,)
        Step of this grid [s].
    trials : int
        Number of trials, N.
    """

    trial: Whole
    place: Array
    step_s: Array
    trials: int

    def of(self, acceleration: Array) -> Array:
        """Return the displacement at each row.

        Parameters
        ----------
        acceleration : ndarray, shape (C, N, P)
            C accelerations along the path of each trial [m/s²].

        Returns
        -------
        ndarray, shape (E, C)
            Displacements, by cubic Hermite interpolation on the grid [m].
        """
        at_places = np.concatenate(integrals(), axis=1).T
        ends = np.searchsorted(self.trial, np.arange(self.trials + 1))
        displacement = np.empty((self.trial.size, len(acceleration)))
        start = 0  # a few trials at a time: an array of all rows by all grid times is large
        while start < self.trials:
            stop = int(np.searchsorted(ends, ends[start] + ROWS_AT_ONCE, side="right")) - 1
            stop = max(stop, start + 1)
            added = self._at_rows(slice(ends[start], ends[stop])) @ at_places
            for trial in range(start, stop):
                rows = slice(ends[trial], ends[trial + 1])
                own = added[rows.start - ends[start] : rows.stop - ends[start]]
                np.matmul(own, acceleration[:, trial].T, out=displacement[rows])
            start = stop
        return displacement

    def _at_rows(self, rows: slice) -> csr_array:
        """Return the weights of speed and travel on a grid of unit steps for some rows, (e, 2 P).

        They are the weights of cubic Hermite interpolation, with the units of the rows' grids.
        """
        left = np.minimum(self.place[rows].astype(int), POINTS - 2)
        share = self.place[rows] - left
        rise = share**2 * (3 - 2 * share)
        bend = share * (1 - share)
        weights = np.stack([bend * (1 - share), -bend * share, 1 - rise, rise], axis=1)
        weights *= self.step_s[rows, None] ** 2
        places = left[:, None] + [0, 1, POINTS, POINTS + 1]
        ends = np.arange(0, weights.size + 1, 4)
        return csr_array((weights.ravel(), places.ravel(), ends), shape=(left.size, 2 * POINTS))


@cache
def integrals() -> tuple[Array, Array]:
    """Return matrices of the first and second integral of values on a grid of unit steps.

    A row of values times such a matrix is the row of its integrals, shape (P, P) each.
    """
    first = scipy.integrate.cumulative_simpson(np.eye(POINTS), axis=1, initial=0)
    return first, np.asarray(scipy.integrate.cumulative_simpson(first, axis=1, initial=0))


DEGREE = 4  # of the travel in time; a force that changes linearly in time needs 3
LEAST_SPEED_SHARE = 0.02  # lower bound of a smoothed speed, relative to the trial's highest speed
NO_EVENTS = Unsupported("It acts on the times of single events, and no trial has any.")
NO_MOTION = Unsupported(
    "It depends on how fast and how far a trial runs, and only accelerations were recorded. State "
    "the travel to examine it (`rig.limits.travel_m`)."
)


@dataclass(frozen=True)
class Paths:
    """Motion of N trials on a grid of P times from the first event to the last.

    Parameters
    ----------
    step_s : ndarray, shape (N, 1)
        Step of the grid [s].
    speed_m_s, acceleration_m_s2 : ndarray, shape (N, P)
        Speed [m/s] and acceleration [m/s²].
    """

    step_s: Array
    speed_m_s: Array
    acceleration_m_s2: Array

    @property
    def travel_m(self) -> Array:
        """Travel since the first time of the grid, shape (N, P) [m]."""
        return np.asarray(self.step_s * (self.speed_m_s @ integrals()[0]))

    def of(self, trials: Whole | slice) -> "Paths":
        """Return the paths of some trials, by index."""
        return Paths(self.step_s[trials], self.speed_m_s[trials], self.acceleration_m_s2[trials])

    def response(self, events: Events, acceleration_m_s2: Array) -> Array:
        """Return the response of the travel to accelerations along the paths.

        Parameters
        ----------
        events : Events
            Events of these trials.
        acceleration_m_s2 : ndarray, shape (K, N, P)
            Accelerations on the grid [m/s²].

        Returns
        -------
        ndarray, shape (K, E)
            Added travel at each event; at the first time of a trial it is 0, and so is the added
            speed [m].
        """
        step = self.step_s[events.trial, 0]
        integral = DoubleIntegral(events.trial, events.tau / step, step, len(self.step_s))
        return integral.of(acceleration_m_s2).T

    def seen(self, acceleration_m_s2: Array) -> Array:
        """Return the added travel, with a constant and a linear function of time projected out."""
        travel = self.step_s**2 * (acceleration_m_s2 @ integrals()[1])
        line = np.stack([np.ones(POINTS), np.linspace(-1, 1, POINTS)])
        line /= np.linalg.norm(line, axis=1, keepdims=True)
        return np.asarray(travel - travel @ line.T @ line)


def motion_unknown(effect: Effect, gravity: Gravity, rig: RigConstants) -> Unsupported | None:
    """Return why the response of these trials to an effect is not known; None if it is known.

    Trials without events show neither speed nor travel, nor the times at which magnets passed.
    """
    if not gravity.events.empty:
        return None
    if effect.acts_on == "reading":
        return NO_EVENTS
    is_known = not (effect.along_path or effect.components) or "travel_m" in rig.limits
    return None if is_known else NO_MOTION


def trial_paths(gravity: Gravity, rig: RigConstants) -> Paths:
    """Return the smoothed motion of each trial.

    Parameters
    ----------
    gravity : Gravity
        N trials that are used, and their events.
    rig : RigConstants
        Constants of the board, for the travel of trials without events.

    Returns
    -------
    Paths
        Motion by least-squares polynomials in time, common to both sensors.
    """
    trials = gravity.trials
    with_events = stands_in(trials["trial"], gravity.events["trial"]).to_numpy()
    shape = (len(trials), POINTS)
    step, speed, acceleration = np.empty((len(trials), 1)), np.empty(shape), np.empty(shape)
    if with_events.any():
        events = prepare_events(gravity.events, trials["trial"][with_events])
        step[with_events], speed[with_events], acceleration[with_events] = _smooth(events)
    if not with_events.all():
        alone = ~with_events
        stated = np.maximum(trials["acceleration_m_s2"].to_numpy(dtype=np.float64)[alone], 0.0)
        travel = rig.limits.get("travel_m", (0.0, TRAVEL_M))[1]
        moving = np.where(stated > 0, stated, np.inf)  # without acceleration the step is 0
        step[alone] = (np.sqrt(2 * travel / moving) / (POINTS - 1))[:, None]
        acceleration[alone] = stated[:, None]
        speed[alone] = (step * np.arange(POINTS) * acceleration)[alone]
    return Paths(step, speed, acceleration)


def _smooth(events: Events) -> tuple[Array, Array, Array]:
    """Return step, speed and acceleration of each trial's polynomial."""
    count = events.starts.size
    duration = np.maximum.reduceat(events.tau, events.starts)
    grid = np.linspace(-1, 1, POINTS)
    speed = np.empty((count, POINTS))
    acceleration = np.empty((count, POINTS))
    for trial, rows in enumerate(events.rows_of_trials()):
        place = 2 * events.tau[rows] / duration[trial] - 1
        sensors = events.regressors[:2, rows][events.present[:2, trial]]
        # A trial with few events has a constant acceleration.
        degree = min(DEGREE, max(2, place.size // 5))
        columns = [-sensors.T, legendre.legvander(place, degree)[:, 1:]]
        fit = np.linalg.lstsq(np.hstack(columns), events.displacement[rows], rcond=None)[0]
        series = np.append(0.0, fit[-degree:])
        per_s = 2 / duration[trial]
        speed[trial] = legendre.legval(grid, legendre.legder(series)) * per_s
        acceleration[trial] = legendre.legval(grid, legendre.legder(series, 2)) * per_s**2
    least = LEAST_SPEED_SHARE * speed.max(axis=1, keepdims=True)
    return duration[:, None] / (POINTS - 1), np.maximum(speed, least), acceleration

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

import numpy as np
from numpy.polynomial import legendre

from bayesfric.arrays import Array, Whole
from bayesfric.effects import Effect
from bayesfric.physics.gravity import TRAVEL_M
from bayesfric.recording.frames import stands_in
from bayesfric.recording.tables import Gravity, RigConstants
from bayesfric.rigs.base import Unsupported
from bayesfric.rigs.gravity_board.double_integral import POINTS, DoubleIntegral, integrals
from bayesfric.rigs.gravity_board.trial_motion import Events, prepare_events

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

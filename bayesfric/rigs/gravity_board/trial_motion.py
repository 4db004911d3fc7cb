"""The events of trials as flat arrays, and their motion by least squares (the pilot fit).

A trial's motion since its first event is x(t) = v0 τ + a τ²/2. Displacements have an offset for
each sensor. They are linear in these four coefficients.
"""

from collections.abc import Hashable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.physics.gravity import Condition
from bayesfric.recording.tables import RigConstants

NUISANCES = 3  # offsets of the two sensors and first speed


def trial_condition(
    trials: pd.DataFrame | pd.Series | Mapping[Hashable, Any], rig: RigConstants
) -> Condition:
    """Return the conditions of N trials, arrays of shape (N,), or those of one trial."""
    columns = ("n_pulleys", "wrap_angle_deg", "mass_drive_kg", "mass_load_kg")
    n, wrap, drive, load = (np.asarray(trials[name], dtype=np.float64) for name in columns)
    return Condition(n, wrap, drive, load, rig.gravity_m_s2)


@dataclass(frozen=True)
class PilotFit:
    """Least-squares motion of N trials.

    Parameters
    ----------
    first_speed, acceleration : ndarray, shape (N,)
        Speed at the trial's first event [m/s] and acceleration [m/s²].
    last_speed : ndarray, shape (N,)
        Speed at the trial's last event [m/s].
    least_speed : ndarray, shape (N,)
        Least speed at any event [m/s].
    rms_residual : float
        Rms residual of all events [m].
    """

    first_speed: Array
    acceleration: Array
    last_speed: Array
    least_speed: Array
    rms_residual: float


@dataclass(frozen=True)
class Events:
    """Events of N trials, sorted by trial, as flat arrays.

    Parameters
    ----------
    starts : ndarray of int, shape (N,)
        Index of each trial's first event.
    trial : ndarray of int, shape (E,)
        Index of each event's trial.
    tau : ndarray, shape (E,)
        Time since the trial's first event [s].
    displacement : ndarray, shape (E,)
        Travel since the sensor's first event [m].
    regressors : ndarray, shape (R, E)
        −1 for events of the drive sensor, −1 for those of the load sensor, τ, and τ²/2; further
        regressors may follow or be inserted.
    present : ndarray of bool, shape (4, N)
        Whether each of the first four regressors is not 0 for a trial.
    """

    starts: Whole
    trial: Whole
    tau: Array
    displacement: Array
    regressors: Array
    present: Flags

    def part(self, trials: slice, rows: slice) -> "Events":
        """Return the events of some adjacent trials, which are in these rows."""
        return Events(
            self.starts[trials] - rows.start,
            self.trial[rows] - trials.start,
            self.tau[rows],
            self.displacement[rows],
            self.regressors[:, rows],
            self.present[:, trials],
        )

    def rows_of_trials(self) -> Iterator[slice]:
        """Yield the slice of each trial's rows."""
        ends = np.append(self.starts[1:], self.tau.size)
        yield from map(slice, self.starts, ends)

    def nuisances(self, rows: slice) -> Array:
        """Return the regressors of offsets and first speed for a trial's rows, if not 0."""
        columns = self.regressors[:NUISANCES, rows]
        return np.asarray(columns[(columns != 0).any(axis=1)])

    @property
    def of_sensors(self) -> Flags:
        """Whether each row is of the drive sensor, and of the load sensor, shape (2, E)."""
        return np.asarray(self.regressors[:2] != 0)

    def speed(self, fit: Array) -> Array:
        """Return the speed at each event by coefficients of :func:`least_squares`, (E,) [m/s]."""
        return np.asarray(fit[self.trial, 2] + fit[self.trial, 3] * self.tau)

    def total(self, values: Array) -> Array:
        """Return the sums of values (last axis) over the events of each trial."""
        return np.add.reduceat(values, self.starts, axis=-1)

    def normal_equations(self, weights: Array, response: Array) -> Array:
        """Return weighted sums of products of the regressors and a response, over each trial.

        Parameters
        ----------
        weights : ndarray, shape (V, E)
            V sets of weights of the events.
        response : ndarray, shape (E,)
            Response, the last column after the R regressors.

        Returns
        -------
        ndarray, shape (V, N, R + 1, R + 1)
            Symmetric matrices. The diagonal is 1 for a nuisance that a trial does not have.
        """
        columns = np.vstack([self.regressors, response])
        row, column = np.triu_indices(len(columns))
        whole = np.empty((len(weights), self.starts.size, len(columns), len(columns)))
        for trial, rows in enumerate(self.rows_of_trials()):
            block = columns[:, rows]  # fits into the cache, unlike all events together
            sums = weights[:, rows] @ (block[row] * block[column]).T
            whole[:, trial, row, column] = whole[:, trial, column, row] = sums
        for place in range(NUISANCES):
            whole[:, ~self.present[place], place, place] = 1.0
        return whole


def prepare_events(events: pd.DataFrame, trial_ids: pd.Series) -> Events:
    """Return the events of some trials, sorted by trial.

    Parameters
    ----------
    events : DataFrame
        Event table of a recording; each of `trial_ids` has events.
    trial_ids : Series of str, length N
        Identifiers of the trials, in the order of the result.

    Returns
    -------
    Events
        Events with the regressors of a motion at constant acceleration.
    """
    place = pd.Index(trial_ids).get_indexer(events["trial"])
    order = np.argsort(place, kind="stable")[np.count_nonzero(place < 0) :]
    trial = place[order]
    starts = np.flatnonzero(np.diff(trial, prepend=-1))
    time = events["time_s"].to_numpy()[order]
    tau = time - np.minimum.reduceat(time, starts)[trial]
    drive = (events["sensor"].to_numpy() == "drive")[order]
    regressors = np.stack([-1.0 * drive, -1.0 * ~drive, tau, tau**2 / 2])
    present = np.logical_or.reduceat(regressors != 0, starts, axis=-1)
    displacement = events["displacement_m"].to_numpy()[order]
    return Events(starts, trial, tau, displacement, regressors, present)


def pilot_fits(events: pd.DataFrame, trial_ids: pd.Series) -> PilotFit:
    """Fit each trial's motion by ordinary least squares.

    Parameters
    ----------
    events : DataFrame
        Event table of a recording; each of `trial_ids` has events.
    trial_ids : Series of str, length N
        Identifiers of the trials, in the order of the result.

    Returns
    -------
    PilotFit
        Motions in the order of `trial_ids`.
    """
    return pilot_of(prepare_events(events, trial_ids))


def pilot_of(table: Events) -> PilotFit:
    """Fit each trial's motion as :func:`pilot_fits` does, from sorted events."""
    fit = pilot_coefficients(table)
    speed = table.speed(fit)
    residual = (table.regressors * fit[table.trial].T).sum(axis=0) - table.displacement
    freedom = table.tau.size - table.present.sum()
    return PilotFit(
        first_speed=fit[:, 2],
        acceleration=fit[:, 3],
        last_speed=fit[:, 2] + fit[:, 3] * np.maximum.reduceat(table.tau, table.starts),
        least_speed=np.minimum.reduceat(speed, table.starts),
        rms_residual=float(np.sqrt((residual**2).sum() / freedom)),
    )


def pilot_coefficients(table: Events) -> Array:
    """Return offsets, first speed and acceleration of each trial, shape (N, 4)."""
    return least_squares(table, np.ones(table.tau.size))


def least_squares(table: Events, weight: Array, precision: Array | float = 0.0) -> Array:
    """Return the coefficients of each trial's regressors by weighted least squares, (N, R).

    Coefficients beyond the first four have normal priors around 0 with this precision [1/m²].
    """
    whole = table.normal_equations(weight[None], table.displacement)[0]
    matrix, right = whole[:, :-1, :-1], whole[:, :-1, -1:]
    for place in range(4, len(table.regressors)):
        matrix[:, place, place] += precision
    return np.asarray(np.linalg.solve(matrix, right)[..., 0])

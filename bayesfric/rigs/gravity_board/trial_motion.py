"""The events of trials as flat arrays, and the motion that least squares see in them.

A trial's motion is x(t) = v0 τ + a τ²/2 since its first event, with an offset of each
sensor: linear in all four.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.physics.gravity import Condition
from bayesfric.recording.tables import RigConstants

NUISANCES = 3  # offsets of the two sensors and first speed


def trial_condition(trials: pd.DataFrame, rig: RigConstants) -> Condition:
    """Return the condition of each trial, arrays of shape (N,)."""
    return Condition(
        trials["n_pulleys"].to_numpy(dtype=np.float64),
        trials["wrap_angle_deg"].to_numpy(dtype=np.float64),
        trials["mass_drive_kg"].to_numpy(dtype=np.float64),
        trials["mass_load_kg"].to_numpy(dtype=np.float64),
        rig.gravity_m_s2,
    )


@dataclass(frozen=True)
class PilotFit:
    """Least-squares motion of each trial, with its sensors' offsets.

    Parameters
    ----------
    first_speed, acceleration : ndarray, shape (N,)
        Speed at the trial's first event [m/s] and acceleration [m/s²].
    last_speed : ndarray, shape (N,)
        Speed at the trial's last event [m/s].
    least_speed : ndarray, shape (N,)
        Least speed at any event [m/s].
    rms_residual : float
        Of all the events [m].
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
        Place of each trial's first row.
    trial : ndarray of int, shape (E,)
        Trial of each event.
    tau : ndarray, shape (E,)
        Time since the trial's first event [s].
    displacement : ndarray, shape (E,)
        Travel since the sensor's first event [m].
    regressors : ndarray, shape (R, E)
        −[drive], −[load], τ, τ²/2, and u_k of each effect.
    present : ndarray of bool, shape (R, N)
        Whether a trial has the regressor at all.
    """

    starts: Whole
    trial: Whole
    tau: Array
    displacement: Array
    regressors: Array
    present: Flags

    def part(self, trials: slice, rows: slice) -> "Events":
        """Return those of some trials, which are in these rows."""
        return Events(
            self.starts[trials] - rows.start,
            self.trial[rows] - trials.start,
            self.tau[rows],
            self.displacement[rows],
            self.regressors[:, rows],
            self.present[:, trials],
        )

    def rows_of_trials(self) -> Iterator[slice]:
        """Yield the rows of each trial."""
        ends = np.append(self.starts[1:], self.tau.size)
        yield from map(slice, self.starts, ends)

    def nuisances(self, rows: slice) -> Array:
        """Return what offsets and first speed do to a trial's rows; those that it has."""
        columns = self.regressors[:NUISANCES, rows]
        return np.asarray(columns[(columns != 0).any(axis=1)])

    @property
    def of_sensors(self) -> Flags:
        """Which rows are of which of both sensors, shape (2, E)."""
        return np.asarray(self.regressors[:2] != 0)

    def total(self, values: Array) -> Array:
        """Sum events over each trial (last axis)."""
        return np.add.reduceat(values, self.starts, axis=-1)

    def normal_equations(self, weights: Array, response: Array) -> Array:
        """Return sums over each trial of the products of regressors and response, weighted.

        Parameters
        ----------
        weights : ndarray, shape (V, E)
            V weights of each event.
        response : ndarray, shape (E,)
            Comes last, after the R regressors.

        Returns
        -------
        ndarray, shape (V, N, R + 1, R + 1)
            Symmetric; absent nuisances are unit.
        """
        columns = np.vstack([self.regressors, response])
        row, column = np.triu_indices(len(columns))
        whole = np.empty((len(weights), self.starts.size, len(columns), len(columns)))
        for trial, rows in enumerate(self.rows_of_trials()):
            block = columns[:, rows]  # fits a cache, as all events at once do not
            sums = weights[:, rows] @ (block[row] * block[column]).T
            whole[:, trial, row, column] = whole[:, trial, column, row] = sums
        for place in range(NUISANCES):
            whole[:, ~self.present[place], place, place] = 1.0
        return whole


def prepare_events(events: pd.DataFrame, trial_ids: pd.Series) -> Events:
    """Sort events by trial.

    Parameters
    ----------
    events : DataFrame
        Event table of a recording; each of `trial_ids` has events.
    trial_ids : Series of str, length N
        The trials, in the order of the result.

    Returns
    -------
    Events
        With the regressors of a motion at constant acceleration.
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
        The trials, in the order of the result.

    Returns
    -------
    PilotFit
        In the order of `trial_ids`.
    """
    return pilot_of(prepare_events(events, trial_ids))


def pilot_of(table: Events) -> PilotFit:
    """Do as :func:`pilot_fits`, of trials whose events are sorted already."""
    fit = pilot_coefficients(table)
    speed = fit[table.trial, 2] + fit[table.trial, 3] * table.tau
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
    whole = table.normal_equations(np.ones((1, table.tau.size)), table.displacement)[0]
    return np.asarray(np.linalg.solve(whole[:, :-1, :-1], whole[:, :-1, -1:])[..., 0])

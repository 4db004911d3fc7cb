"""Trains of events, each of one trial and sensor, and quadratic fits to many trains.

A quadratic in time is a motion at constant acceleration, seen by one sensor.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.recording.spacing import spacing_counts

SENSORS = ("drive", "load")


@dataclass(frozen=True)
class EventTrains:
    """E events of K trains; those of a train are adjacent and in order of time.

    Parameters
    ----------
    row : ndarray of int, shape (E,)
        Row of each event in the original table.
    starts : ndarray of int, shape (K,)
        Index of the first event of each train.
    train : ndarray of int, shape (E,)
        Index of each event's train.
    trial : ndarray of int, shape (K,)
        Index of each train's trial.
    sensor : ndarray of int, shape (K,)
        Index of each train's sensor in :data:`SENSORS`.
    time : ndarray, shape (E,)
        Time since the first event of the trial, of either sensor [s].
    count : ndarray, shape (E,)
        Displacement in spacings, whole numbers.
    """

    row: Whole
    starts: Whole
    train: Whole
    trial: Whole
    sensor: Whole
    time: Array
    count: Array

    @property
    def sizes(self) -> Whole:
        """Number of events of each train, shape (K,)."""
        return np.diff(np.append(self.starts, self.train.size))

    def keep(self, events: Flags) -> "EventTrains":
        """Return the trains with some of their events, without trains that have none of them.

        Parameters
        ----------
        events : ndarray of bool, shape (E,)
            Which events are kept.
        """
        place, train = np.unique(self.train[events], return_inverse=True)
        return EventTrains(
            self.row[events],
            np.flatnonzero(np.diff(train, prepend=-1)),
            train,
            self.trial[place],
            self.sensor[place],
            self.time[events],
            self.count[events],
        )

    def of_both_sensors(self, least: int) -> "EventTrains":
        """Return the trains of trials whose two sensors have at least so many events."""
        enough = self.sizes >= least
        trials = int(self.trial.max(initial=-1)) + 1
        both = np.bincount(self.trial[enough], minlength=trials) == 2
        return self.keep((enough & both[self.trial])[self.train])


def event_trains(events: pd.DataFrame, trial_ids: pd.Series, spacing_m: float) -> EventTrains:
    """Sort events into trains.

    Parameters
    ----------
    events : DataFrame
        Event table of a recording, in any order of rows; may be empty.
    trial_ids : Series of str, length N
        Identifiers of the trials; events of other trials are ignored.
    spacing_m : float
        Travel between two events [m].

    Returns
    -------
    EventTrains
        Trains sorted by trial, in the order of `trial_ids`, and by sensor.
    """
    trial = pd.Index(trial_ids).get_indexer(pd.Index(events["trial"]))
    sensor = pd.Index(SENSORS).get_indexer(pd.Index(events["sensor"]))
    time = events["time_s"].to_numpy(dtype=np.float64)
    key = trial * len(SENSORS) + sensor
    row = np.lexsort((time, key))[np.count_nonzero(trial < 0) :]
    starts = np.flatnonzero(np.diff(key[row], prepend=-1))
    of_trial = np.flatnonzero(np.diff(trial[row], prepend=-1))
    first = np.minimum.reduceat(time[row], of_trial) if row.size else time[row]
    origin = np.repeat(first, np.diff(np.append(of_trial, row.size)))
    return EventTrains(
        row,
        starts,
        np.repeat(np.arange(starts.size), np.diff(np.append(starts, row.size))),
        trial[row][starts],
        sensor[row][starts],
        time[row] - origin,
        spacing_counts(events["displacement_m"].to_numpy(dtype=np.float64)[row], spacing_m),
    )


@dataclass(frozen=True)
class QuadraticFits:
    """Weighted least-squares quadratics in time, one for each train.

    Parameters
    ----------
    acceleration : ndarray, shape (K,)
        Second derivative [spacings/s²].
    acceleration_variance : ndarray, shape (K,)
        Variance of `acceleration` if the weights are inverse variances [spacings²/s⁴].
    rest_time : ndarray, shape (K,)
        Time at which the speed of the quadratic is zero, on the clock of the train [s]. It is
        before the first event if the motion accelerates, and not finite if the second
        derivative is zero.
    speed : ndarray, shape (E,)
        First derivative at each event [spacings/s].
    residual : ndarray, shape (E,)
        Event minus quadratic [spacings].
    leverage : ndarray, shape (E,)
        Leverage of each event, the derivative of its fitted by its measured value.
    """

    acceleration: Array
    acceleration_variance: Array
    rest_time: Array
    speed: Array
    residual: Array
    leverage: Array


def quadratic_fits(trains: EventTrains, weight: Array) -> QuadraticFits:
    """Fit a quadratic in time to each train.

    Parameters
    ----------
    trains : EventTrains
        Trains of at least three events each.
    weight : ndarray, shape (E,)
        Weight of each event.

    Returns
    -------
    QuadraticFits
        Fits in spacings and seconds.
    """
    train, starts = trains.train, trains.starts
    ends = np.append(starts[1:], train.size) - 1
    half = 0.5 * (trains.time[ends] - trains.time[starts])
    middle = 0.5 * (trains.time[ends] + trains.time[starts])
    u = (trains.time - middle[train]) / half[train]  # −1 to 1, for the condition of the matrix
    columns = np.stack([np.ones_like(u), u, u**2])
    weighted = columns * weight
    gram = np.empty((starts.size, 3, 3))
    for i in range(3):
        for j in range(i, 3):
            gram[:, i, j] = gram[:, j, i] = np.add.reduceat(weighted[i] * columns[j], starts)
    inverse = np.linalg.inv(gram)
    right = np.add.reduceat(weighted * trains.count, starts, axis=1)
    fit = np.einsum("kij,jk->ik", inverse, right)
    spread = np.einsum("ije,je->ie", inverse.transpose(1, 2, 0)[:, :, train], columns)
    with np.errstate(divide="ignore", invalid="ignore"):
        rest = -fit[1] / (2 * fit[2])
    return QuadraticFits(
        rest_time=middle + half * rest,
        acceleration=2 * fit[2] / half**2,
        acceleration_variance=4 * inverse[:, 2, 2] / half**4,
        speed=(fit[1, train] + 2 * fit[2, train] * u) / half[train],
        residual=trains.count - (fit[:, train] * columns).sum(axis=0),
        leverage=(columns * spread).sum(axis=0) * weight,
    )

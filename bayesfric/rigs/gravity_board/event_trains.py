"""The events of one trial and sensor, a *train*, and quadratics through many trains.

A quadratic in time is the motion at constant acceleration, by one sensor alone.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.recording.spacing import spacing_counts

SENSORS = ("drive", "load")


@dataclass(frozen=True)
class EventTrains:
    """E events of K trains, those of a train adjacent and in order of time.

    Parameters
    ----------
    row : ndarray of int, shape (E,)
        Place of each event in the table that it comes from.
    starts : ndarray of int, shape (K,)
        Where each train begins.
    train : ndarray of int, shape (E,)
        Place of the event's train.
    trial : ndarray of int, shape (K,)
        Place of the train's trial.
    sensor : ndarray of int, shape (K,)
        Place in :data:`SENSORS`.
    time : ndarray, shape (E,)
        Since the first event of the trial, either sensor's [s].
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
        """Events of each train, shape (K,)."""
        return np.diff(np.append(self.starts, self.train.size))

    def keep(self, events: Flags) -> "EventTrains":
        """Return the trains with a part of their events; a train with none is gone.

        Parameters
        ----------
        events : ndarray of bool, shape (E,)
            Which stay.
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


def event_trains(events: pd.DataFrame, trial_ids: pd.Series, spacing_m: float) -> EventTrains:
    """Sort events into trains, whatever the order of the rows.

    Parameters
    ----------
    events : DataFrame
        Event table of a recording; may be empty.
    trial_ids : Series of str, length N
        The trials; events of others are passed over.
    spacing_m : float
        Travel between two events [m].

    Returns
    -------
    EventTrains
        Sorted by trial, in the order of `trial_ids`, and sensor.
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
    """Weighted least-squares quadratics in time, one a train.

    Parameters
    ----------
    acceleration : ndarray, shape (K,)
        Second derivative [spacings/s²].
    acceleration_variance : ndarray, shape (K,)
        Its variance where the weights are inverse variances.
    rest_time : ndarray, shape (K,)
        When the quadratic's speed is zero, on the clock of the train; before the first event of
        a motion that gathers speed [s]. Where the second derivative is zero it is not finite.
    speed : ndarray, shape (E,)
        First derivative at each event [spacings/s].
    residual : ndarray, shape (E,)
        Event less quadratic [spacings].
    leverage : ndarray, shape (E,)
        How much of its own deviation the fit takes up at each event.
    """

    acceleration: Array
    acceleration_variance: Array
    rest_time: Array
    speed: Array
    residual: Array
    leverage: Array


def quadratic_fits(trains: EventTrains, weight: Array) -> QuadraticFits:
    """Fit each train.

    Parameters
    ----------
    trains : EventTrains
        Each of at least three events.
    weight : ndarray, shape (E,)
        Of each event.

    Returns
    -------
    QuadraticFits
        In spacings and seconds.
    """
    train, starts = trains.train, trains.starts
    ends = np.append(starts[1:], train.size) - 1
    half = 0.5 * (trains.time[ends] - trains.time[starts])
    middle = 0.5 * (trains.time[ends] + trains.time[starts])
    u = (trains.time - middle[train]) / half[train]  # −1 to 1: well conditioned
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

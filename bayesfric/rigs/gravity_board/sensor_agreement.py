"""Agreement of the motions that the two sensors of a trial measured.

Both sensors measure the same cable. Their accelerations are fitted separately, over the time that
both cover, and should differ only by noise of the events. The statistic z is the difference over
its standard error. The difference times the moving mass, relative to friction, is the difference
of the two estimates of friction.

The sensors of a trial disagree if both exceed their limits. By noise alone, |z| exceeds its limit
in a share `TAIL` of trials. The second limit has two reasons. A significant difference that is
smaller than the scatter of friction does not justify excluding a trial. And if friction changes
along the travel, the quadratics of the two sensors differ slightly, because their events are not
at the same places.
"""

from dataclasses import dataclass
from functools import cached_property
from statistics import NormalDist

import numpy as np
import pandas as pd

from bayesfric.arrays import Array
from bayesfric.recording.consistency import MINIMUM_EVENTS
from bayesfric.recording.tables import RigConstants
from bayesfric.rigs.gravity_board.event_trains import EventTrains, event_trains, quadratic_fits
from bayesfric.rigs.gravity_board.trial_motion import trial_condition

TAIL = 1e-4  # probability of |z| above its limit by noise alone
MATERIAL_SHARE = 0.01  # limit of the difference of frictions; their mean is wrong by half of that
CLIPPED = 4.0  # standard deviations: events beyond are ignored in the estimate of the noise
NORMAL_MEDIAN_SQUARE = 0.4549  # median of a squared standard normal
NOISE_ROUNDS = 8
LEAST_LIMIT = NormalDist().inv_cdf(1 - TAIL / 2)  # limit of |z| if the noise is known exactly


@dataclass(frozen=True)
class SensorAgreement:
    """Agreement of the two sensors of each trial.

    Parameters
    ----------
    trials : DataFrame
        One row for each trial with two sensors: `trial`; `z` of drive minus load sensor;
        `friction_share`, the relative difference of their frictions (infinite if the motion
        leaves no friction); `disagrees`.
    freedom : int or None
        Degrees of freedom of the estimated noise. None without trials.
    """

    trials: pd.DataFrame
    freedom: int | None

    @cached_property
    def limit(self) -> float | None:
        """Limit of |z|: 3.89, or more if few events determine the noise. None without trials."""
        return None if self.freedom is None else _limit(self.freedom)


def sensor_agreement(
    events: pd.DataFrame, trials: pd.DataFrame, rig: RigConstants
) -> SensorAgreement:
    """Compare the sensors of each trial.

    Parameters
    ----------
    events : DataFrame
        Event table, after repair; may be empty.
    trials : DataFrame
        Trial table of a recording.
    rig : RigConstants
        Constants of the board: spacing, clock and gravity.

    Returns
    -------
    SensorAgreement
        Trials in the order of `trials`. A trial needs five events of each sensor in their common
        time; other trials have no row.
    """
    columns = ["trial", "z", "friction_share", "disagrees"]
    if events.empty:
        return SensorAgreement(pd.DataFrame(columns=columns), None)
    assert rig.hall_spacing_m and rig.timer_resolution_s
    spacing = rig.hall_spacing_m
    trains = _common_time(event_trains(events, trials["trial"], spacing))
    if not trains.starts.size:
        return SensorAgreement(pd.DataFrame(columns=columns), None)
    fits = quadratic_fits(trains, 1 / noise_variance(trains, rig.timer_resolution_s))
    drive, load = fits.acceleration.reshape(-1, 2).T
    difference = drive - load
    z = difference / np.sqrt(fits.acceleration_variance.reshape(-1, 2).sum(axis=1))
    compared = trials.iloc[trains.trial[::2]]
    condition = trial_condition(compared, rig)
    mass = condition.total_mass_kg
    friction = condition.drive_force_n - mass * 0.5 * (drive + load) * spacing
    share = np.full(z.size, np.inf)
    np.divide(mass * np.abs(difference) * spacing, friction, out=share, where=friction > 0)
    freedom = trains.time.size - 3 * trains.starts.size
    disagrees = (np.abs(z) > LEAST_LIMIT) & (share > MATERIAL_SHARE)
    if disagrees.any():
        disagrees &= np.abs(z) > _limit(freedom)
    table = pd.DataFrame(
        {
            "trial": compared["trial"].to_numpy(),
            "z": z,
            "friction_share": share,
            "disagrees": disagrees,
        }
    )
    return SensorAgreement(table, freedom)


def _limit(freedom: int) -> float:
    from scipy.special import stdtrit  # late: nearly no recording has a trial near the limit

    return -float(stdtrit(freedom, TAIL / 2))


def _common_time(trains: EventTrains) -> EventTrains:
    """Return the events in the common time of a trial's sensors, if each has five or more.

    In a common time, friction that changes slowly has nearly the same influence on both sensors.
    """
    last = np.append(trains.starts[1:], trains.train.size) - 1
    trials = int(trains.trial.max()) + 1
    start, end = np.full(trials, -np.inf), np.full(trials, np.inf)
    np.maximum.at(start, trains.trial, trains.time[trains.starts])
    np.minimum.at(end, trains.trial, trains.time[last])
    trial = trains.trial[trains.train]
    common = trains.keep((trains.time >= start[trial]) & (trains.time <= end[trial]))
    return common.of_both_sensors(MINIMUM_EVENTS)


def noise_variance(trains: EventTrains, tick_s: float) -> Array:
    """Return each event's variance, σx² + σt² v², from residuals of all trains.

    The estimate is a weighted regression of squared residuals on squared speed, with weights from
    the previous iteration. σx² is at least 0, and σt² is at least the variance by rounding of the
    clock to ticks of `tick_s`.
    """
    fits, tick2 = quadratic_fits(trains, np.ones(trains.time.size)), tick_s**2 / 12
    residual, leverage, speed2 = fits.residual, fits.leverage, fits.speed**2
    square = residual**2 / np.maximum(1 - leverage, 1e-6)
    variance = np.full(square.size, np.median(square) / NORMAL_MEDIAN_SQUARE) + tick2 * speed2
    for _ in range(NOISE_ROUNDS):
        weight = (square <= CLIPPED**2 * variance) / variance**2
        s0, s1, s2 = weight.sum(), (weight * speed2).sum(), (weight * speed2**2).sum()
        y0, y1 = (weight * square).sum(), (weight * square * speed2).sum()
        clock = (s0 * y1 - s1 * y0) / (s0 * s2 - s1**2)
        place = (y0 - s1 * clock) / s0
        if not place > 0:  # also where all speeds are equal
            place, clock = 0.0, y1 / s2
        elif clock < tick2:
            place, clock = max(y0 - s1 * tick2, 0.0) / s0, tick2
        variance = place + max(clock, tick2) * speed2
    return np.asarray(variance)

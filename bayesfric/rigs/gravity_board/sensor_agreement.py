"""Whether the two sensors of a trial saw the same motion.

Both sensors watch one cable, so their accelerations, each fitted by itself, differ
by event noise alone. Over the time that both cover, the difference over its
standard error is z; times the moving mass and over the friction it is the share
by which the two would differ in friction.

A trial disagrees if |z| is beyond the limit *and* the share is. Noise alone passes
the first in a share `TAIL` of trials. The second is there since a sharp difference
that moves a trial's friction by less than trials scatter is no reason to lose one,
and since friction that changes on the way gives the sensors, whose events are not
at the same places, quadratics that differ a little.
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

TAIL = 1e-4  # probability of a |z| beyond the limit by noise alone
MATERIAL_SHARE = 0.01  # of friction; the mean of both is then off by half of it
CLIPPED = 4.0  # standard deviations: events beyond do not inform the noise
NORMAL_MEDIAN_SQUARE = 0.4549  # median of a squared standard normal
NOISE_ROUNDS = 8
LEAST_LIMIT = NormalDist().inv_cdf(1 - TAIL / 2)  # of |z|, however many events tell the noise


@dataclass(frozen=True)
class SensorAgreement:
    """Agreement of the two sensors, trial by trial.

    Parameters
    ----------
    trials : DataFrame
        One row a trial with two sensors: `trial`; `z`, drive less load;
        `friction_share`, by which their frictions differ (infinite where the
        motion leaves no friction); `disagrees`.
    freedom : int or None
        Degrees of freedom, by which the events tell the noise. None without trials.
    """

    trials: pd.DataFrame
    freedom: int | None

    @cached_property
    def limit(self) -> float | None:
        """Of |z|: 3.89, or more where few events tell the noise. None without trials."""
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
        For spacing, clock and gravity.

    Returns
    -------
    SensorAgreement
        Trials in the order of `trials`; those whose sensors share less than five
        events each have no row.
    """
    columns = ["trial", "z", "friction_share", "disagrees"]
    if events.empty:
        return SensorAgreement(pd.DataFrame(columns=columns), None)
    assert rig.hall_spacing_m and rig.timer_resolution_s
    spacing = rig.hall_spacing_m
    trains = _common_time(event_trains(events, trials["trial"], spacing))
    if not trains.starts.size:
        return SensorAgreement(pd.DataFrame(columns=columns), None)
    pilot = quadratic_fits(trains, np.ones(trains.time.size))
    variance = noise_variance(
        pilot.residual, pilot.leverage, pilot.speed**2, rig.timer_resolution_s**2 / 12
    )
    fits = quadratic_fits(trains, 1 / variance)
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
    """Keep the events while both sensors of a trial have some, if five of each remain.

    Over one span of time, friction that is not quite constant shows alike in both.
    """
    last = np.append(trains.starts[1:], trains.train.size) - 1
    trials = int(trains.trial.max()) + 1
    start, end = np.full(trials, -np.inf), np.full(trials, np.inf)
    np.maximum.at(start, trains.trial, trains.time[trains.starts])
    np.minimum.at(end, trains.trial, trains.time[last])
    trial = trains.trial[trains.train]
    common = trains.keep((trains.time >= start[trial]) & (trains.time <= end[trial]))
    enough = common.sizes >= MINIMUM_EVENTS
    both = enough & (np.bincount(common.trial[enough], minlength=trials) == 2)[common.trial]
    return common.keep(both[common.train])


def noise_variance(residual: Array, leverage: Array, speed2: Array, tick2: float) -> Array:
    """Return each event's variance, σx² + σt² v², from residuals of all trains.

    By moments: squared residuals against squared speed, weighted by the fit itself,
    neither variance below zero, the clock's not below that of rounding it.
    """
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

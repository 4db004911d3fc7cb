"""The difference of the clocks of the two sensors of a trial.

Both ends of a cable start from rest together. A quadratic through the events of one sensor gives
the time of the start on the clock of this sensor. The difference of the two times is the delay of
the load sensor's clock. If a sensor reads all travel too long, for example with slip of the cable,
speed and acceleration are too large by the same factor, and the time of the start is unchanged.

The cable itself explains only a small difference: a stretch takes half a millisecond from one mass
to the other. An offset of a few times this value is a nuisance parameter of each trial, which
likelihood and diagnosis integrate out. A larger offset means that a clock is wrong. It would bias
c1: an offset of 50 ms by 6 %.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.polynomial import legendre

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.errors import Fault
from bayesfric.recording.consistency import MINIMUM_EVENTS
from bayesfric.recording.tables import RigConstants
from bayesfric.rigs.gravity_board.event_trains import EventTrains, event_trains, quadratic_fits
from bayesfric.rigs.gravity_board.late_clock import SHIFT, clock_sd_s, to_unit_diagonal
from bayesfric.rigs.gravity_board.sensor_agreement import noise_variance

FURTHEST = 5.0  # largest offset that a cable explains, in prior standard deviations
SURE_SD = 5.0  # standard errors at which an excess over that, or over SAME_SHARE, is significant
SHARP = 10.0  # least acceleration over its standard error for an estimate of the time of the start
LARGEST_LOSS = 0.05  # share of common time by which a first estimate may reduce it
SAME_SHARE = 0.01  # largest relative error of a sensor's travel if only the clocks differ
ROUNDS = 3  # iterations: the common motion depends on the offset
DEGREE, EVENTS_A_POWER = 5, 4  # of the common motion; with fewer events it is a parabola
LEAST_VARIANCE = 1e-10  # of an event, for data without noise [spacings²]
RIDGE = 1e-13  # added to a unit diagonal, for columns that are zero or linearly dependent
NAMED_TRIALS = 2  # largest number of trials that a message names


@dataclass(frozen=True)
class SensorClocks:
    """Delays of the load sensor's clock relative to the drive sensor's.

    Parameters
    ----------
    trials : DataFrame
        One row for each trial whose offset was estimated: `trial`; `late_s`, the delay of the
        load sensor's clock, and its standard error `sd_s` [s]; `same_motion`, false if the
        sensors differ by more than their clocks.
    allowed_sd_s : float
        Prior standard deviation of an offset [s].
    stated : bool
        Whether the recording states this standard deviation.
    late_s, sd_s : float or None
        Mean delay of the trials with the same motion, between which it may vary, and its standard
        error [s]; None without such trials.
    """

    trials: pd.DataFrame
    allowed_sd_s: float
    stated: bool
    late_s: float | None
    sd_s: float | None

    @property
    def furthest_s(self) -> float:
        """The largest plausible offset, :data:`FURTHEST` prior standard deviations [s]."""
        return FURTHEST * self.allowed_sd_s

    @property
    def described(self) -> str | None:
        """The offset with its error in words; None if no trial has two comparable sensors."""
        if self.trials.empty:
            return None
        alike = int(self.trials["same_motion"].sum())
        if self.late_s is None or self.sd_s is None:
            return (
                f"not comparable: in all {len(self.trials)} trials the sensors differ by more than "
                "their clocks"
            )
        within = f"the fit estimates each trial's offset, up to {1e3 * self.furthest_s:.3g} ms"
        return f"{_in_words(self.late_s, self.sd_s)}, {alike} trials; {within}"


def sensor_clocks(events: pd.DataFrame, trial_ids: pd.Series, rig: RigConstants) -> SensorClocks:
    """Estimate the offset between the clocks of each trial's sensors.

    Parameters
    ----------
    events : DataFrame
        Event table, after repair; may be empty.
    trial_ids : Series of str, length N
        Identifiers of the trials.
    rig : RigConstants
        Constants of the board: spacing, clock, and the stated prior of an offset.

    Returns
    -------
    SensorClocks
        Trials in the order of `trial_ids`. A trial needs five events of each of two sensors;
        other trials have no row.
    """
    trains, allowed = None, (clock_sd_s(rig), rig.sensor_clock_sd_s is not None)
    if len(events):
        assert rig.hall_spacing_m and rig.timer_resolution_s
        trains = event_trains(events, trial_ids, rig.hall_spacing_m)
        trains = trains.of_both_sensors(MINIMUM_EVENTS)
    if trains is None or not trains.starts.size:
        columns = ["trial", "late_s", "sd_s", "same_motion"]
        return SensorClocks(pd.DataFrame(columns=columns), *allowed, None, None)
    trial, late, sd, same = _offsets(trains, rig.timer_resolution_s or 0.0)
    table = pd.DataFrame(
        {
            "trial": trial_ids.to_numpy()[trial],
            "late_s": late,
            "sd_s": sd,
            "same_motion": same,
        }
    )[np.isfinite(sd)].reset_index(drop=True)
    alike = table[table["same_motion"]]
    if alike.empty:
        return SensorClocks(table, *allowed, None, None)
    pooled = _pooled(alike["late_s"].to_numpy(), alike["sd_s"].to_numpy())
    return SensorClocks(table, *allowed, *pooled)


def _offsets(trains: EventTrains, tick_s: float) -> tuple[Whole, Array, Array, Flags]:
    """Return index, offset, its standard error and sameness of motion for each trial.

    The first estimate is the difference of the two times of the start. It is rejected if it reduces
    the common time of the sensors, because the time of the start of a trial that soon moves evenly
    is a long extrapolation. Then the events of both sensors are fitted by one smooth motion, with
    three differences between the sensors: an offset of the travel, a relative error of the travel,
    and the delay times the speed.
    """
    variance = np.maximum(noise_variance(trains, tick_s), LEAST_VARIANCE)
    fits = quadratic_fits(trains, 1 / variance)
    sharp = np.abs(fits.acceleration) > SHARP * np.sqrt(fits.acceleration_variance)
    drive, load = fits.rest_time.reshape(-1, 2).T
    nearer = _overlap(trains, load - drive) > _overlap(trains, np.zeros_like(drive)) - LARGEST_LOSS
    late = np.where(nearer & sharp.reshape(-1, 2).all(axis=1), load - drive, 0.0)
    events = _Padded.of(trains, variance)
    for _ in range(ROUNDS):
        further, share, deviation = events.differences(late)
        late = late + further
    relative_error, its_sd = np.abs(share), deviation[1]
    same = (relative_error <= SAME_SHARE) | (relative_error <= SURE_SD * its_sd)
    return trains.trial[::2], late, deviation[0], same


def _overlap(trains: EventTrains, late_s: Array) -> Array:
    """Return the common time of the sensors over the shorter of their times, shape (n,).

    It is negative if there is a gap between the two times.
    """
    first = np.concatenate([[0], np.cumsum(trains.sizes)[:-1]])
    start = np.minimum.reduceat(trains.time, first).reshape(-1, 2)
    end = np.maximum.reduceat(trains.time, first).reshape(-1, 2)
    start[:, 1], end[:, 1] = start[:, 1] - late_s, end[:, 1] - late_s
    common = end.min(axis=1) - start.max(axis=1)
    return np.asarray(common / (end - start).min(axis=1))


@dataclass(frozen=True)
class _Padded:
    """Events of n trials, one trial in each row; shorter rows are padded with zero weights."""

    time: Array
    count: Array
    is_load: Array
    weight: Array

    @classmethod
    def of(cls, trains: EventTrains, variance: Array) -> "_Padded":
        """Return the events of trains in rows."""
        sizes = trains.sizes.reshape(-1, 2).sum(axis=1)
        row = np.repeat(np.arange(sizes.size), sizes)
        place = row, np.arange(row.size) - np.repeat(np.cumsum(sizes) - sizes, sizes)

        def padded(values: Array) -> Array:
            rows = np.zeros((sizes.size, int(sizes.max())))
            rows[place] = values
            return rows

        is_load = padded(trains.sensor[trains.train].astype(np.float64))
        return cls(padded(trains.time), padded(trains.count), is_load, padded(1 / variance))

    def differences(self, late_s: Array) -> tuple[Array, Array, Array]:
        """Return the load sensor's further delay, its relative error of travel, and their sd.

        Parameters
        ----------
        late_s : ndarray, shape (n,)
            Delay that is subtracted from the load sensor's times beforehand [s].
        """
        seen = self.weight > 0
        time = self.time - self.is_load * late_s[:, None]
        low = np.where(seen, time, np.inf).min(axis=1, keepdims=True)
        half = 0.5 * (np.where(seen, time, -np.inf).max(axis=1, keepdims=True) - low)
        u = np.where(seen, (time - low) / half - 1, 0.0)
        powers = legendre.legvander(u, DEGREE)
        few = seen.sum(axis=1) < EVENTS_A_POWER * DEGREE
        powers[few, :, 3:] = 0.0
        smooth = [*np.moveaxis(powers, -1, 0), self.is_load]
        motion, _, _ = self._fit(smooth)
        wave = motion[:, : DEGREE + 1].T
        steps = legendre.legder(np.eye(DEGREE + 1), axis=0)
        rates = np.einsum("npk,kj,jn->np", powers[..., :-1], steps, wave)
        travel = np.einsum("npj,jn->np", powers, wave)
        travel = travel - np.where(seen, travel, np.inf).min(axis=1, keepdims=True)
        both = [self.is_load * rates / half, self.is_load * travel]
        fit, inverse, square = self._fit([*smooth, *both])
        freedom = np.maximum(seen.sum(axis=1) - fit.shape[1] + few * (DEGREE - 2), 1)
        spread = square / freedom
        spread = np.maximum(spread, np.median(spread))  # that of a few events may be too small
        late, share = fit[:, -2], fit[:, -1]
        diagonal = np.maximum(inverse[:, [-2, -1], [-2, -1]].T, 0.0)
        return -late, share, np.sqrt(diagonal * spread)

    def _fit(self, columns: list[Array]) -> tuple[Array, Array, Array]:
        """Return the weighted least-squares fit by columns, its covariance, and its squares."""
        design = np.stack(columns, axis=-1)
        weighted = design * self.weight[..., None]
        gram = np.matmul(weighted.swapaxes(1, 2), design)
        unit, size = to_unit_diagonal(gram)
        inverse = (
            np.linalg.inv(unit + RIDGE * np.eye(len(columns))) / size[:, :, None] / size[:, None, :]
        )
        right = np.matmul(weighted.swapaxes(1, 2), self.count[..., None])
        fit = np.matmul(inverse, right)
        square = (self.weight * (self.count - np.matmul(design, fit)[..., 0]) ** 2).sum(axis=1)
        return fit[..., 0], inverse, square


def _pooled(late_s: Array, sd_s: Array) -> tuple[float, float]:
    """Return the mean of offsets that vary between trials, and its standard error.

    The variance between trials is estimated by the moments of DerSimonian and Laird.
    """
    weight = sd_s**-2.0
    mean = float(weight @ late_s / weight.sum())
    excess = float(weight @ (late_s - mean) ** 2) - (late_s.size - 1)
    spare = float(weight.sum() - (weight**2).sum() / weight.sum())
    between = max(excess, 0.0) / spare if spare > 0 else 0.0
    weight = 1 / (sd_s**2 + between)
    return float(weight @ late_s / weight.sum()), float(weight.sum() ** -0.5)


def clock_faults(clocks: SensorClocks) -> list[Fault]:
    """Return a fault if the clocks differ by more than :attr:`SensorClocks.furthest_s`."""
    if clocks.late_s is None or clocks.sd_s is None:
        return []
    alike = clocks.trials[clocks.trials["same_motion"]]
    beyond = alike["late_s"].abs() - clocks.furthest_s > SURE_SD * alike["sd_s"]
    pooled = abs(clocks.late_s) - clocks.furthest_s > SURE_SD * clocks.sd_s
    if not pooled and not beyond.any():
        return []
    far = alike[beyond]
    count = f"in {len(far) or len(alike)} of {len(alike)} trials"
    if pooled:
        offsets_in_words = f"{_in_words(clocks.late_s, clocks.sd_s)} {count}"
    else:
        first = far[:NAMED_TRIALS]
        offsets = zip(first["trial"], first["late_s"], first["sd_s"], strict=True)
        names = [f"{trial}: {_in_words(late, sd)}" for trial, late, sd in offsets]
        offsets_in_words = f"{count}: {'; '.join(names)}{'; …' if len(far) > NAMED_TRIALS else ''}"
    most = f"{1e3 * clocks.furthest_s:.3g} ms"
    why, state = f"no cable explains more than {most}", "state rig.sensor_clock_sd_s"
    if clocks.stated:
        why = f"{FURTHEST:.0f} times rig.sensor_clock_sd_s is {most}"
        state = "state a larger rig.sensor_clock_sd_s"
    expected = f"two sensors on one clock; {why}: correct time_s of one sensor, or {state}"
    return [Fault("gravity_events.csv", expected, column="time_s", value=offsets_in_words)]


def _in_words(late_s: float, sd_s: float) -> str:
    """Return an offset with its error, and which clock is late."""
    scale, unit = (1.0, "s") if abs(late_s) >= 1 else (1e3, "ms")
    digits = int(np.clip(1 - np.floor(np.log10(max(scale * sd_s, 1e-9))), 0, 9))
    which = "load" if late_s > 0 else "drive"
    return f"{abs(scale * late_s):.{digits}f} ± {scale * sd_s:.{digits}f} {unit} ({which} late)"


def on_one_clock(events: pd.DataFrame, clocks: SensorClocks, rig: RigConstants) -> pd.DataFrame:
    """Put both sensors of a trial on one clock, if the recording states the prior of an offset.

    The most likely offset is subtracted from the times of the load sensor. The rest of the offset
    is a nuisance parameter, so this only chooses the value around which a trial is linearised.

    Parameters
    ----------
    events : DataFrame
        Event table.
    clocks : SensorClocks
        Offsets of these events.
    rig : RigConstants
        Constants of the board. Without a stated prior, the events are returned unchanged.

    Returns
    -------
    DataFrame
        Events with the column :data:`.late_clock.SHIFT`.
    """
    if rig.sensor_clock_sd_s is None or clocks.trials.empty:
        return events
    variance, prior = clocks.trials["sd_s"] ** 2, clocks.allowed_sd_s**2
    likely = (clocks.trials["late_s"] * prior / (prior + variance)).to_numpy()
    shift = pd.Series(likely, index=clocks.trials["trial"])
    of_trial = events["trial"].map(shift).fillna(0.0).to_numpy(dtype=np.float64)
    moved = np.where(events["sensor"] == "load", of_trial, 0.0)
    return events.assign(time_s=events["time_s"] - moved, **{SHIFT: moved})

"""The difference of the clocks of the two sensors of a trial.

Both ends of a cable start from rest together. A quadratic through the events of one sensor gives
the time of the start on the clock of this sensor. The difference of the two times is the delay of
the load sensor's clock. If a sensor reads all travel too long, for example with slip of the cable,
speed and acceleration are too large by the same factor, and the time of the start is unchanged.

The cable itself explains only a small difference: a stretch takes half a millisecond from one mass
to the other. Within a few times this value the offset is a nuisance parameter of each trial, which
likelihood and diagnosis integrate out. With a larger offset a clock is wrong, and c1 would be
too: at 50 ms by 6 %.
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
from bayesfric.rigs.gravity_board.late_clock import SHIFT, clock_sd_s
from bayesfric.rigs.gravity_board.sensor_agreement import noise_variance

FURTHEST = 5.0  # of these standard deviations, that no cable explains
SURE_SD = 5.0  # standard errors by which an offset is beyond them
SHARP = 10.0  # standard errors of an acceleration that tells when the cable was at rest
LESS = 0.05  # of a sensor's time: by so much less of it in common, a first estimate is none
SAME_SHARE = 0.01  # by which a sensor reads too long: beyond it, not only the clocks differ
ROUNDS = 3  # the motion of both sensors is known once their clocks are
DEGREE, EVENTS_A_POWER = 5, 4  # of the motion that both see; fewer events tell a parabola
LEAST_VARIANCE = 1e-10  # of an event, where there is no noise [spacings²]
RIDGE = 1e-13  # of the unit diagonal: where a column is absent, or nothing tells two apart
NAMED = 2  # trials in a message


@dataclass(frozen=True)
class SensorClocks:
    """Offsets of the load sensor's clock from the drive sensor's.

    Parameters
    ----------
    trials : DataFrame
        One row a trial whose two sensors saw when the cable was at rest: `trial`; `late_s`, by
        how much the load sensor's clock is late, and its standard error `sd_s` [s];
        `same_motion`, false where the sensors differ by more than their clocks.
    allowed_sd_s : float
        Standard deviation of the prior of an offset [s].
    stated : bool
        Whether the recording says it.
    late_s, sd_s : float or None
        The offset of all trials with the same motion together, which may differ from trial to
        trial, and its standard error [s]; None without such trials.
    """

    trials: pd.DataFrame
    allowed_sd_s: float
    stated: bool
    late_s: float | None
    sd_s: float | None

    @property
    def furthest_s(self) -> float:
        """The largest offset that the prior explains [s]."""
        return FURTHEST * self.allowed_sd_s

    @property
    def described(self) -> str | None:
        """The offset with its error in words; None where no trial has two sensors to compare."""
        if self.trials.empty:
            return None
        alike = int(self.trials["same_motion"].sum())
        if self.late_s is None or self.sd_s is None:
            return (
                f"not to be compared: in all {len(self.trials)} trials the sensors differ by more"
            )
        within = f"the fit estimates each trial's offset, up to {1e3 * self.furthest_s:.3g} ms"
        return f"{_said(self.late_s, self.sd_s)}, {alike} trials; {within}"


def sensor_clocks(events: pd.DataFrame, trial_ids: pd.Series, rig: RigConstants) -> SensorClocks:
    """Estimate the offset between the clocks of each trial's sensors.

    Parameters
    ----------
    events : DataFrame
        Event table, after repair; may be empty.
    trial_ids : Series of str, length N
        The trials.
    rig : RigConstants
        For spacing, clock and what is stated of the offset.

    Returns
    -------
    SensorClocks
        Trials in the order of `trial_ids`; those without two sensors of five events each, or
        whose acceleration is not sharp, have no row.
    """
    trains, allowed = None, (clock_sd_s(rig), rig.sensor_clock_sd_s is not None)
    if len(events):
        assert rig.hall_spacing_m and rig.timer_resolution_s
        trains = _of_both(event_trains(events, trial_ids, rig.hall_spacing_m))
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
    together = _together(alike["late_s"].to_numpy(), alike["sd_s"].to_numpy())
    return SensorClocks(table, *allowed, *together)


def _of_both(trains: EventTrains) -> EventTrains:
    """Return the trains of trials whose two sensors have enough events."""
    enough = trains.sizes >= MINIMUM_EVENTS
    if not enough.any():
        return trains.keep(np.zeros(trains.time.size, dtype=bool))
    both = np.bincount(trains.trial[enough], minlength=int(trains.trial.max()) + 1) == 2
    return trains.keep((enough & both[trains.trial])[trains.train])


def _offsets(trains: EventTrains, tick_s: float) -> tuple[Whole, Array, Array, Flags]:
    """Return place, offset, standard error and sameness of motion of each trial.

    When both sensors were at rest is a first estimate, unless by it they saw the mass at other
    times than by their clocks as they are: the rest time of a trial that soon moves evenly is an
    extrapolation by far. Then both are fitted by one smooth motion each: an offset of the load
    sensor, a share by which it reads all travel too long, and the speed times how late it is are
    what the two sensors may differ by.
    """
    pilot = quadratic_fits(trains, np.ones(trains.time.size))
    variance = noise_variance(pilot.residual, pilot.leverage, pilot.speed**2, tick_s**2 / 12)
    fits = quadratic_fits(trains, 1 / np.maximum(variance, LEAST_VARIANCE))
    sharp = np.abs(fits.acceleration) > SHARP * np.sqrt(fits.acceleration_variance)
    drive, load = fits.rest_time.reshape(-1, 2).T
    nearer = _overlap(trains, load - drive) > _overlap(trains, np.zeros_like(drive)) - LESS
    late = np.where(nearer & sharp.reshape(-1, 2).all(axis=1), load - drive, 0.0)
    events = _Padded.of(trains, np.maximum(variance, LEAST_VARIANCE))
    for _ in range(ROUNDS):
        further, share, deviation = events.apart(late)
        late = late + further
    longer, unsure = np.abs(share), deviation[1]
    same = (longer <= SAME_SHARE) | (longer <= SURE_SD * unsure)
    return trains.trial[::2], late, deviation[0], same


def _overlap(trains: EventTrains, late_s: Array) -> Array:
    """Return in which share of the shorter sensor's time both saw the mass, shape (n,).

    Below 0 where there is a time between.
    """
    first = np.concatenate([[0], np.cumsum(trains.sizes)[:-1]])
    start = np.minimum.reduceat(trains.time, first).reshape(-1, 2)
    end = np.maximum.reduceat(trains.time, first).reshape(-1, 2)
    start[:, 1], end[:, 1] = start[:, 1] - late_s, end[:, 1] - late_s
    common = end.min(axis=1) - start.max(axis=1)
    return np.asarray(common / (end - start).min(axis=1))


@dataclass(frozen=True)
class _Padded:
    """Events of n trials, a trial a row, each row filled up to the longest by zero weights."""

    time: Array
    count: Array
    is_load: Array
    weight: Array

    @classmethod
    def of(cls, trains: EventTrains, variance: Array) -> "_Padded":
        """Lay the events out."""
        sizes = trains.sizes.reshape(-1, 2).sum(axis=1)
        row = np.repeat(np.arange(sizes.size), sizes)
        place = row, np.arange(row.size) - np.repeat(np.cumsum(sizes) - sizes, sizes)

        def laid(values: Array) -> Array:
            whole = np.zeros((sizes.size, int(sizes.max())))
            whole[place] = values
            return whole

        is_load = laid(trains.sensor[trains.train].astype(np.float64))
        return cls(laid(trains.time), laid(trains.count), is_load, laid(1 / variance))

    def apart(self, late_s: Array) -> tuple[Array, Array, Array]:
        """Return how much later, and by which share longer, the load sensor reads; their errors.

        Parameters
        ----------
        late_s : ndarray, shape (n,)
            What is taken off its clock beforehand [s].
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
        spread = square / freedom  # by a trial's own events, the few of a short one not trusted
        spread = np.maximum(spread, np.median(spread))
        late, share = fit[:, -2], fit[:, -1]
        diagonal = np.maximum(inverse[:, [-2, -1], [-2, -1]].T, 0.0)
        return -late, share, np.sqrt(diagonal * spread)

    def _fit(self, columns: list[Array]) -> tuple[Array, Array, Array]:
        """Return the fit of the events by columns, its covariance, and the sum of squares."""
        design = np.stack(columns, axis=-1)
        weighted = design * self.weight[..., None]
        gram = np.matmul(weighted.swapaxes(1, 2), design)
        size = np.sqrt(np.diagonal(gram, axis1=1, axis2=2))
        size = np.where(size > 0, size, 1.0)
        gram = gram / size[:, :, None] / size[:, None, :] + RIDGE * np.eye(len(columns))
        inverse = np.linalg.inv(gram) / size[:, :, None] / size[:, None, :]
        right = np.matmul(weighted.swapaxes(1, 2), self.count[..., None])
        fit = np.matmul(inverse, right)
        square = (self.weight * (self.count - np.matmul(design, fit)[..., 0]) ** 2).sum(axis=1)
        return fit[..., 0], inverse, square


def _together(late_s: Array, sd_s: Array) -> tuple[float, float]:
    """Return the mean of offsets that may differ from trial to trial, and its standard error.

    The variance between trials is that of DerSimonian and Laird, by moments.
    """
    weight = sd_s**-2.0
    mean = float(weight @ late_s / weight.sum())
    excess = float(weight @ (late_s - mean) ** 2) - (late_s.size - 1)
    spare = float(weight.sum() - (weight**2).sum() / weight.sum())
    between = max(excess, 0.0) / spare if spare > 0 else 0.0
    weight = 1 / (sd_s**2 + between)
    return float(weight @ late_s / weight.sum()), float(weight.sum() ** -0.5)


def clock_faults(clocks: SensorClocks) -> list[Fault]:
    """Return the fault of clocks that differ by more than the prior explains; none elsewhere."""
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
        offsets_in_words = f"{_said(clocks.late_s, clocks.sd_s)} {count}"
    else:
        first = far[:NAMED]
        offsets = zip(first["trial"], first["late_s"], first["sd_s"], strict=True)
        names = [f"{trial}: {_said(late, sd)}" for trial, late, sd in offsets]
        offsets_in_words = f"{count}: {'; '.join(names)}{'; …' if len(far) > NAMED else ''}"
    most = f"{1e3 * clocks.furthest_s:.3g} ms"
    why, state = f"no cable explains more than {most}", "state rig.sensor_clock_sd_s"
    if clocks.stated:
        why = f"{FURTHEST:.0f} times rig.sensor_clock_sd_s is {most}"
        state = "state a larger rig.sensor_clock_sd_s"
    expected = f"two sensors on one clock; {why}: correct time_s of one sensor, or {state}"
    return [Fault("gravity_events.csv", expected, column="time_s", value=offsets_in_words)]


def _said(late_s: float, sd_s: float) -> str:
    """Return an offset with its error, and which clock is late."""
    scale, unit = (1.0, "s") if abs(late_s) >= 1 else (1e3, "ms")
    digits = int(np.clip(1 - np.floor(np.log10(max(scale * sd_s, 1e-9))), 0, 9))
    which = "load" if late_s > 0 else "drive"
    return f"{abs(scale * late_s):.{digits}f} ± {scale * sd_s:.{digits}f} {unit} ({which} late)"


def on_one_clock(events: pd.DataFrame, clocks: SensorClocks, rig: RigConstants) -> pd.DataFrame:
    """Put both sensors of a trial on one clock, where the recording says how far they may be off.

    The times of the load sensor are moved by the most likely offset. What is left of it is a
    nuisance, so that this chooses no more than the point around which a trial is linear.

    Parameters
    ----------
    events : DataFrame
        Event table.
    clocks : SensorClocks
        Of it.
    rig : RigConstants
        Where nothing is stated, the events are returned as they are.

    Returns
    -------
    DataFrame
        With the column :data:`.late_clock.SHIFT`.
    """
    if rig.sensor_clock_sd_s is None or clocks.trials.empty:
        return events
    variance, prior = clocks.trials["sd_s"] ** 2, clocks.allowed_sd_s**2
    likely = (clocks.trials["late_s"] * prior / (prior + variance)).to_numpy()
    shift = pd.Series(likely, index=clocks.trials["trial"])
    of_trial = events["trial"].map(shift).fillna(0.0).to_numpy(dtype=np.float64)
    moved = np.where(events["sensor"] == "load", of_trial, 0.0)
    return events.assign(time_s=events["time_s"] - moved, **{SHIFT: moved})

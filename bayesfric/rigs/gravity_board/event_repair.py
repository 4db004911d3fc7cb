"""Detection and repair of missed, doubled and stray Hall events, by a stated rule.

The recorder counts events. After a missed event, all later displacements of this sensor are one
spacing too small. After an event that was counted twice, they are one spacing too large. The
motion shows such faults: between two neighbouring events the cable travels one spacing, and
nearby events predict the position of the cable to much less than half a spacing.

Nothing is changed in a train (the events of one trial and sensor) if all its events lie within
`CLEAN_SPACING` of a quadratic in time. In other trains, the motion is followed in both directions
from the `SEED` consecutive events that fit a quadratic best. A quadratic through the nearest
events, at most `WINDOW`, predicts the position of the next one. The nearest whole number of
spacings is the place of this event. If two events have the same place, one of them is a doubled
event. An event further than `AMBIGUOUS_FROM` from all places is a stray. Doubled and stray events
are removed. A displacement that skips a spacing at a matching time is kept: an event is missing
there, but the count is right.

The motion is assumed to be smooth over a few events only, so that runout of a pulley or viscous
friction is not taken for a fault.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.lib.stride_tricks import sliding_window_view

from bayesfric.arrays import Array, Flags
from bayesfric.recording.consistency import MINIMUM_EVENTS
from bayesfric.rigs.gravity_board.event_trains import SENSORS, event_trains, quadratic_fits

CLEAN_SPACING = 0.05  # in spacings: 0.5 mm, five times the noise of a poor sensor (0.1 mm)
SEED = 6  # events: three more than a quadratic has coefficients
WINDOW = 6  # events: with more, a fast change of friction at a slow start looks like a fault
AMBIGUOUS_FROM = 0.4  # in spacings; at a distance of 0.4 to 0.5 the nearest place is ambiguous
LEFT_OVER = 0.25  # in spacings: largest residual after repair
LARGEST_SHARE = 0.2  # largest share of faulty events in a train that is repaired
NOISE_LIMIT = 5.0  # in standard deviations: beyond it, the later of two edges may be the right one
NORMAL_MAD = 0.6745  # median absolute deviation of a standard normal


@dataclass(frozen=True)
class RepairedEvents:
    """Repaired events, and a table of the repairs.

    Parameters
    ----------
    events : DataFrame
        Recorded events without the removed ones, with corrected displacements.
    repaired : DataFrame
        One row for each train that was repaired or dropped: `trial` and `sensor`; number of
        `missed` and `doubled` events; `removed`, the number of removed rows; `used`, false if
        the train could not be repaired and was dropped.
    """

    events: pd.DataFrame
    repaired: pd.DataFrame


@dataclass(frozen=True)
class _Repair:
    """Repair of one train: places of its events in spacings, and which events are kept."""

    place: Array
    kept: Flags
    missed: int
    doubled: int
    usable: bool


def repair_events(
    events: pd.DataFrame, trial_ids: pd.Series, *, spacing_m: float
) -> RepairedEvents:
    """Find missed, doubled and stray events, and repair or drop each train with such events.

    Parameters
    ----------
    events : DataFrame
        Event table of a recording, in any order of rows; may be empty.
    trial_ids : Series of str, length N
        Identifiers of the trials.
    spacing_m : float
        Travel between two events [m].

    Returns
    -------
    RepairedEvents
        Its `events` are the argument itself if no train has a fault. A second repair changes
        nothing.
    """
    trains = event_trains(events, trial_ids, spacing_m)
    sizes = trains.sizes
    odd = sizes < MINIMUM_EVENTS
    enough = trains.keep(~odd[trains.train])
    if enough.starts.size:
        residual = quadratic_fits(enough, np.ones(enough.time.size)).residual
        odd[~odd] = np.maximum.reduceat(np.abs(residual), enough.starts) > CLEAN_SPACING
    displacement = events["displacement_m"].to_numpy(dtype=np.float64, copy=True)
    stays = np.ones(len(events), dtype=bool)
    rows = []
    for train in np.flatnonzero(odd):
        part = slice(trains.starts[train], trains.starts[train] + sizes[train])
        row, recorded = trains.row[part], trains.count[part]
        if recorded.size >= WINDOW and _is_smooth(trains.time[part], recorded):
            continue
        repair = _repair(trains.time[part], recorded)
        if repair.usable and not (repair.missed or repair.doubled) and repair.kept.all():
            continue
        stays[row] = repair.kept & repair.usable
        moved = repair.kept & (repair.place != recorded)
        displacement[row[moved]] = repair.place[moved] * spacing_m
        rows.append(
            {
                "trial": trial_ids.iloc[trains.trial[train]],
                "sensor": SENSORS[trains.sensor[train]],
                "missed": repair.missed,
                "doubled": repair.doubled,
                "removed": int(np.count_nonzero(~stays[row])),
                "used": repair.usable,
            }
        )
    columns = ["trial", "sensor", "missed", "doubled", "removed", "used"]
    if rows:
        events = events.assign(displacement_m=displacement)[stays]
    return RepairedEvents(events, pd.DataFrame(rows, columns=columns))


def _is_smooth(time: Array, recorded: Array) -> bool:
    """Return whether each event is close to the motion of its neighbours."""
    return bool(np.abs(_window_residuals(time, recorded, WINDOW)).max() <= CLEAN_SPACING)


def _repair(time: Array, recorded: Array) -> _Repair:
    """Return the repair of one train."""
    dropped = _Repair(recorded, np.zeros(recorded.size, dtype=bool), 0, 0, usable=False)
    if recorded.size < MINIMUM_EVENTS:
        return dropped
    place = _trace_places(time, recorded)
    if place is None:
        return dropped
    kept = _one_for_each_place(time, place)
    which = np.flatnonzero(kept)
    steps = np.diff(place[which])
    counted = np.diff(recorded[which])
    # Each removed row had advanced the recorder's counter by one.
    excess = steps - (counted - (np.diff(which) - 1))
    seen_twice = np.count_nonzero(~kept & np.isfinite(place))
    missed = int(excess[excess > 0].sum())
    doubled = int(seen_twice - excess[excess < 0].sum())
    left_over = np.abs(_local_residuals(time[which], place[which])).max()
    faults = missed + max(doubled, int(np.count_nonzero(~kept)))
    usable = (
        which.size >= MINIMUM_EVENTS
        and faults <= LARGEST_SHARE * recorded.size
        and left_over <= LEFT_OVER
    )
    return _Repair(place - place[which[0]], kept, missed, doubled, bool(usable))


def _trace_places(time: Array, recorded: Array) -> Array | None:
    """Return each event's place, NaN for a stray; None if no part of the train is clean."""
    width = min(SEED, recorded.size)
    worst = np.abs(_window_residuals(time, recorded, width)).max(axis=1)
    seed = int(worst.argmin())
    if worst[seed] > CLEAN_SPACING:
        return None
    place = np.full(recorded.size, np.nan)
    place[seed : seed + width] = recorded[seed : seed + width]
    placed = list(range(seed, seed + width))
    _extend_places(time, recorded, place, placed, range(seed + width, recorded.size))
    placed = sorted(placed)[WINDOW - 1 :: -1]
    _extend_places(time, recorded, place, placed, range(seed - 1, -1, -1))
    return place


def _extend_places(
    time: Array, recorded: Array, place: Array, placed: list[int], ahead: Iterable[int]
) -> None:
    """Determine the places of the events ahead, one after another.

    `placed` contains one event for each place so far, the nearest to the events ahead last. Of
    two events at one place it contains the one closer to the motion. The list is extended.
    """
    for event in ahead:
        near = placed[-1]
        predicted, speed, _ = _predict(time, place, placed[-WINDOW:], event)
        nearest = np.rint(predicted)
        if speed <= 0:  # the quadratic reverses before this event: keep the recorded step
            nearest = place[near] + recorded[event] - recorded[near]
        elif (
            abs(predicted - nearest) > AMBIGUOUS_FROM
            or (nearest - place[near]) * (event - near) < 0
        ):
            continue
        place[event] = nearest
        if nearest != place[near]:
            placed.append(event)
        else:
            distance, of_near = (
                _scaled_distance(time, place, placed[:-1], candidate) for candidate in (event, near)
            )
            if distance < of_near:
                placed[-1] = event


def _scaled_distance(time: Array, place: Array, placed: list[int], event: int) -> float:
    """Return the distance of an event from the motion of the last placed events.

    The distance is in spacings, divided by its standard deviation for events of unit noise.
    """
    predicted, _, spread = _predict(time, place, placed[-WINDOW:], event)
    return abs(predicted - float(place[event])) / spread


def _predict(
    time: Array, place: Array, nearby: list[int], event: int
) -> tuple[float, float, float]:
    """Return place and slope, at an event, of the quadratic through nearby events.

    The third number is the standard deviation of event minus quadratic for events of unit noise.
    """
    base, scale = nearby[-1], abs(time[nearby[-1]] - time[nearby[0]])
    v = (time[event] - time[base]) / scale
    # Arrays are filled in place: this is called for each event, and stacking costs more.
    columns, sides = np.empty((3, len(nearby))), np.empty((3, 2))
    columns[0] = 1.0
    columns[1] = (time[nearby] - time[base]) / scale
    np.square(columns[1], out=columns[2])
    sides[:, 0] = columns @ (place[nearby] - place[base])
    sides[:, 1] = at = np.array([1.0, v, v**2])
    fit, along = np.linalg.solve(columns @ columns.T, sides).T
    slope = fit[1] + 2 * fit[2] * v
    return float(place[base] + fit @ at), float(slope), float(np.sqrt(1 + at @ along))


def _one_for_each_place(time: Array, place: Array) -> Flags:
    """Return which events are kept: one for each place.

    A contact bounces after its edge, so the first event at a place is kept. If it is further
    from the motion than noise explains, the event closest to the motion is kept instead.
    """
    kept = np.isfinite(place)
    _, first, times = np.unique(place[kept], return_index=True, return_counts=True)
    candidates = np.flatnonzero(kept)
    single = candidates[first]
    residual = _local_residuals(time[single], place[single])
    noise = np.median(np.abs(residual)) / NORMAL_MAD / np.sqrt(1 - 3 / WINDOW)
    for group in np.flatnonzero(times > 1):
        several = candidates[first[group] : first[group] + times[group]]
        others = np.delete(single, group)
        start = int(np.clip(group - WINDOW // 2, 0, max(others.size - WINDOW, 0)))
        nearby = others[start : start + WINDOW].tolist()
        off = np.array([_scaled_distance(time, place, nearby, event) for event in several])
        best = several[0] if off[0] <= NOISE_LIMIT * noise else several[off.argmin()]
        kept[several] = several == best
    return kept


def _local_residuals(time: Array, place: Array) -> Array:
    """Return the residual of each event from the quadratic through those around it."""
    width = min(WINDOW, time.size)
    windows = _window_residuals(time, place, width)
    event = np.arange(time.size)
    start = np.clip(event - width // 2, 0, time.size - width)
    return np.asarray(windows[start, event - start])


def _window_residuals(time: Array, place: Array, width: int) -> Array:
    """Return residuals from a quadratic through each `width` consecutive events, one set a row."""
    u = sliding_window_view(time, width)
    u = u - u.mean(axis=1, keepdims=True)
    u = u / np.abs(u).max(axis=1, keepdims=True)
    y = sliding_window_view(place, width)
    columns = np.stack([np.ones_like(u), u, u**2], axis=-1)
    transposed = columns.swapaxes(-1, -2)
    fit = np.linalg.solve(transposed @ columns, transposed @ y[..., None])
    return np.asarray(y - (columns @ fit)[..., 0])

"""Missed and doubled Hall events, found by the motion and repaired by a stated rule.

The recorder counts events. One that it misses leaves every later displacement of
that sensor a spacing short; one that it sees twice, a spacing long. The motion
tells: between two neighbouring events the cable travels one spacing, and events
nearby predict far better than half of one where the cable is.

A train whose events lie within `CLEAN` of one quadratic in time is left alone.
In another, the motion is followed from its cleanest `SEED` events outwards. A
quadratic through the `WINDOW` events nearest to the next one, at most, says how
far the cable has come, and the nearest whole number of spacings is the event's
place. Two events of one place are one doubled event; an event further than `ODD`
from any place is a stray. Both are taken out. A displacement that skips a spacing,
with a time to match, is right as it stands: there are just fewer data.

No motion is assumed beyond being smooth over a few events, so that runout or
viscous friction do not look like faults.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.lib.stride_tricks import sliding_window_view

from bayesfric.arrays import Array, Flags
from bayesfric.recording.consistency import MINIMUM_EVENTS
from bayesfric.rigs.gravity_board.event_trains import SENSORS, event_trains, quadratic_fits

CLEAN_SPACING = 0.05  # of a spacing: 0.5 mm, five times a poor sensor's noise of 0.1 mm
SEED = 6  # events: three more than a quadratic takes
WINDOW = 6  # events: with more, friction that changes fast at a slow start looks like faults
AMBIGUOUS_FROM = 0.4  # of a spacing; in 0.4 to 0.6 neither neighbour is meant
LEFT_OVER = 0.25  # of a spacing, after repair
LARGEST_SHARE = 0.2  # of a train's events that may be at fault
NOISE_LIMIT = 5.0  # standard deviations, before the later of two edges is believed
NORMAL_MAD = 0.6745  # median absolute deviation of a standard normal


@dataclass(frozen=True)
class RepairedEvents:
    """Events fit for use, and what was done to get there.

    Parameters
    ----------
    events : DataFrame
        As recorded, less the events that were taken out, displacements of repaired
        trains counted anew.
    repaired : DataFrame
        One row a train that was not clean: `trial`, `sensor`; `missed` and `doubled`
        events; `removed`, rows taken out as doubled or stray; `used`, false where
        the train could not be repaired and all of it left.
    """

    events: pd.DataFrame
    repaired: pd.DataFrame


@dataclass(frozen=True)
class _Repair:
    """What becomes of one train: places in spacings, and which events stay."""

    place: Array
    kept: Flags
    missed: int
    doubled: int
    usable: bool


def repair_events(
    events: pd.DataFrame, trial_ids: pd.Series, *, spacing_m: float
) -> RepairedEvents:
    """Find missed, doubled and stray events, and repair each train or drop it.

    Parameters
    ----------
    events : DataFrame
        Event table of a recording, in any order of rows; may be empty.
    trial_ids : Series of str, length N
        The trials.
    spacing_m : float
        Travel between two events [m].

    Returns
    -------
    RepairedEvents
        `events` itself where nothing was wrong. Repairing again changes nothing.
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
    """Return whether no event is off the motion of those around it: nothing is to repair."""
    return bool(np.abs(_window_residuals(time, recorded, WINDOW)).max() <= CLEAN_SPACING)


def _repair(time: Array, recorded: Array) -> _Repair:
    """Count one train anew."""
    nothing = _Repair(recorded, np.zeros(recorded.size, dtype=bool), 0, 0, usable=False)
    if recorded.size < MINIMUM_EVENTS:
        return nothing
    place = _follow(time, recorded)
    if place is None:
        return nothing
    kept = _one_each(time, place)
    which = np.flatnonzero(kept)
    steps = np.diff(place[which])
    counted = np.diff(recorded[which])
    # A row that leaves had advanced the recorder's counter.
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


def _follow(time: Array, recorded: Array) -> Array | None:
    """Return each event's place, NaN for a stray; None where the train has no clean part."""
    width = min(SEED, recorded.size)
    worst = np.abs(_window_residuals(time, recorded, width)).max(axis=1)
    seed = int(worst.argmin())
    if worst[seed] > CLEAN_SPACING:
        return None
    place = np.full(recorded.size, np.nan)
    place[seed : seed + width] = recorded[seed : seed + width]
    placed = list(range(seed, seed + width))
    _extend(time, recorded, place, placed, range(seed + width, recorded.size))
    placed = sorted(placed)[WINDOW - 1 :: -1]
    _extend(time, recorded, place, placed, range(seed - 1, -1, -1))
    return place


def _extend(
    time: Array, recorded: Array, place: Array, placed: list[int], ahead: Iterable[int]
) -> None:
    """Find the places of the events ahead, one by one.

    `known` holds an event for each place found so far, the nearest to what is ahead
    last; of two at one place, the one nearer to the motion. It grows on the way.
    """
    for event in ahead:
        near = placed[-1]
        predicted, speed, _ = _predict(time, place, placed[-WINDOW:], event)
        nearest = np.rint(predicted)
        if speed <= 0:  # the motion would have turned back: it does not reach this far
            nearest = place[near] + recorded[event] - recorded[near]
        elif (
            abs(predicted - nearest) > AMBIGUOUS_FROM
            or (nearest - place[near]) * (event - near) < 0
        ):
            continue
        place[event] = nearest
        if nearest != place[near]:
            placed.append(event)
        elif _off(time, place, placed[:-1], event) < _off(time, place, placed[:-1], near):
            placed[-1] = event


def _off(time: Array, place: Array, placed: list[int], event: int) -> float:
    """Return how far an event is from the motion of those known last.

    In spacings, over the standard deviation that unit noise of the events would give.
    """
    predicted, _, spread = _predict(time, place, placed[-WINDOW:], event)
    return abs(predicted - float(place[event])) / spread


def _predict(
    time: Array, place: Array, nearby: list[int], event: int
) -> tuple[float, float, float]:
    """Return place and slope at an event, of the quadratic through a few others.

    And the standard deviation of event less quadratic for events of unit noise.
    """
    base, scale = nearby[-1], abs(time[nearby[-1]] - time[nearby[0]])
    u = (time[nearby] - time[base]) / scale
    v = (time[event] - time[base]) / scale
    columns = np.stack([np.ones_like(u), u, u**2])
    at = np.array([1.0, v, v**2])
    solved = np.linalg.solve(
        columns @ columns.T, np.column_stack([columns @ (place[nearby] - place[base]), at])
    )
    fit, along = solved.T
    slope = fit[1] + 2 * fit[2] * v
    return float(place[base] + fit @ at), float(slope), float(np.sqrt(1 + at @ along))


def _one_each(time: Array, place: Array) -> Flags:
    """Choose one event for each place.

    A contact bounces after its edge: the first event stays, unless it is off the
    motion by more than noise explains and a later one is not.
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
        off = np.array([_off(time, place, nearby, event) for event in several])
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
    """Return residuals from a quadratic through each run of `width` events, a run a row."""
    u = sliding_window_view(time, width)
    u = u - u.mean(axis=1, keepdims=True)
    u = u / np.abs(u).max(axis=1, keepdims=True)
    y = sliding_window_view(place, width)
    columns = np.stack([np.ones_like(u), u, u**2], axis=-1)
    turned = columns.swapaxes(-1, -2)
    fit = np.linalg.solve(turned @ columns, turned @ y[..., None])
    return np.asarray(y - (columns @ fit)[..., 0])

"""Held readings: a slow sensor in a fast log, which repeats the last value."""

from itertools import pairwise

import numpy as np
import pandas as pd

from bayesfric.arrays import Array, Flags

MOSTLY = 0.9  # share of the intervals between new readings that have the same length
BUSY = 0.9  # share of the changes of position at which the force changes too
CAUGHT_UP = 1.5  # usual steps by which a position moves after a repeated row
COUNTS = 3  # least number of encoder counts by which a held position moves at a time
SENSED = frozenset({"motor", "link", "measured"})  # kinds of force that a sensor measures
ANSWERS = 0.9  # negative correlation of the changes of force with those of position
LEVELS = 20  # a force with fewer values is a test signal of steps, each held on purpose
FEWEST = 10  # least number of new readings for a regular interval
OTHERS = 20  # least number of other intervals that show the clock of a coarse encoder
QUIET = 0.5  # mean square change of a held force within readings, relative to that between them


def renewed(values: Array) -> Flags:
    """Return whether each reading differs from the one before, (N,); true for the first."""
    return np.concatenate([[True], np.diff(values) != 0])


def held_for(values: Array) -> int:
    """Return for how many samples each reading is held; 1 if none is held, or irregularly.

    A coarse encoder also repeats readings if the axis is slow, but at no regular interval. If two
    readings are equal by chance, the interval is a multiple of the regular one, which counts too.

    Parameters
    ----------
    values : ndarray, shape (N,)
        Of evenly sampled rows.
    """
    between = np.diff(np.flatnonzero(renewed(values)[1:]))
    if between.size < FEWEST:
        return 1
    rhythm = int(np.median(between))
    if rhythm < 2:
        return 1
    # An interval that is no whole number of samples alternates between two lengths.
    off = np.abs(between - rhythm * np.maximum(np.round(between / rhythm), 1))
    steady = (off == 0) if rhythm < 4 else (off <= 1)
    return rhythm if float(np.mean(steady)) >= MOSTLY else 1


def has_steps(force: Array) -> bool:
    """Return whether a force takes few values: steps, a square wave, or a binary sequence.

    Such a test signal holds each value as long as telemetry holds a reading, or longer, and it
    really acts so.

    Parameters
    ----------
    force : ndarray, shape (N,)
        Of a run.
    """
    return np.unique(force).size < LEVELS


def stale(position: Array, force: Array) -> Flags:
    """Return which rows repeat the previous one although the axis moved on, shape (N,).

    Telemetry does this if a new row is late. A joint at rest repeats its readings too, but its next
    step is then no larger than usual, whereas a late row is followed by a larger step.

    Parameters
    ----------
    position, force : ndarray, shape (N,)
        Of a run.
    """
    steps = np.abs(np.diff(position))
    moved, pushed = steps > 0, np.diff(force) != 0
    again = ~moved & ~pushed
    nothing = np.zeros(position.size, dtype=np.bool_)
    if again.sum() < FEWEST or not moved.any() or float(np.mean(pushed[moved])) < BUSY:
        return nothing
    after = np.concatenate([[False], again[:-1]]) & moved
    if not after.any():
        return nothing
    usual = float(np.median(steps[moved & ~after])) if (moved & ~after).any() else np.inf
    if float(np.median(steps[after])) < CAUGHT_UP * usual:
        return nothing
    return np.concatenate([[False], again])


def released(samples: pd.DataFrame, force_is: str | None) -> tuple[pd.DataFrame, str | None]:
    """Return a run's samples without repeated readings, and what was done; None if nothing.

    If the position is held, the first row of each reading is kept. A measured force that is held is
    interpolated linearly to its next reading. A commanded force acts as it is held. A force that
    responds to each count of the encoder is reconstructed by :func:`answering`. Rows that repeat
    the previous one although the axis moved on are left out.

    Parameters
    ----------
    samples : DataFrame
        Samples of one run, with columns of ``axis_samples.csv``.
    force_is : str or None
        Kind of the logged force, as in ``rig.force_is``; None if not stated.
    """
    position = samples["position_m"].to_numpy(dtype=np.float64)
    force = samples["force_n"].to_numpy(dtype=np.float64)
    position_held = position_held_for(position, force)
    force_held = held_for(force) if force_is in SENSED and not has_steps(force) else 1
    answers = answering(position, force) if position_held == 1 else None
    if answers is not None:
        force_held = held_for(force)
        samples = samples.assign(force_n=answers)
    elif force_held > 1:
        time, new = samples["time_s"].to_numpy(dtype=np.float64), renewed(force)
        samples = samples.assign(force_n=np.interp(time, time[new], force[new]))
    if position_held > 1:
        new = _readings(position, force)
        if _is_quiet_between(force, new):
            force_held = position_held
            samples = samples.assign(force_n=_means_of(force, new))
        samples = samples[new].reset_index(drop=True)
    held = [
        f"{name} for {count} samples"
        for name, count in (("position", position_held), ("force", force_held))
        if count > 1
    ]
    said = [f"each reading is held, {' and '.join(held)}"] if held else []
    if answers is not None:
        said.append(
            "the force follows each encoder count, and was computed from these between its readings"
        )
    late = stale(*(samples[name].to_numpy(dtype=np.float64) for name in ("position_m", "force_n")))
    if late.any():
        said.append(
            f"{late.sum():,} of {late.size:,} rows repeat the one before, though it moved on"
        )
        samples = samples[~late].reset_index(drop=True)
    return samples, "; ".join(said) or None


def answering(position: Array, force: Array) -> Array | None:
    """Return a held force as it really acted, if it responds to encoder counts; else None.

    The damping of a controller gives a pulse of force at each count. Telemetry that holds the force
    for some samples misses pulses or prolongs them. The counts, which are not held, show all
    pulses.

    Parameters
    ----------
    position, force : ndarray, shape (N,)
        Of evenly sampled rows.
    """
    if held_for(force) == 1 or has_steps(force):
        return None
    new = np.flatnonzero(renewed(force))
    moved = np.diff(position, prepend=position[0])
    quick_force, quick_move = np.diff(force[new], 2), np.diff(moved[new], 2)
    size = float(np.linalg.norm(quick_force) * np.linalg.norm(quick_move))
    along = float(quick_force @ quick_move)
    if size == 0 or along > -ANSWERS * size:
        return None
    kick = along / float(quick_move @ quick_move)
    calm = np.interp(np.arange(force.size), new, force[new] - kick * moved[new])
    return np.asarray(calm + kick * moved)


def position_held_for(position: Array, force: Array) -> int:
    """Return for how many samples each position is held; 1 for a coarse encoder, which is not held.

    A coarse encoder moves by few counts at a time and may rest at one. Its position counts as held
    if it moves only at new readings of the force (one clock then reads both), or only at every
    n-th row, however long it rests between.

    Parameters
    ----------
    position, force : ndarray, shape (N,)
        Of a run.
    """
    if _jumps(position):
        return held_for(position)
    by_force = held_for(force) if _moves_with(position, force) else 1
    return by_force if by_force > 1 else _in_step(position)


def force_is_held(position: Array, force: Array) -> bool:
    """Return whether a force is held as its position is, be it noisy from row to row.

    Parameters
    ----------
    position, force : ndarray, shape (N,)
        Of a run whose position is held.
    """
    return held_for(force) > 1 or _is_quiet_between(force, _readings(position, force))


def _in_step(position: Array) -> int:
    """Return the largest n of which nearly all intervals between moves are multiples, or 1.

    A coarse encoder at one speed moves at equal intervals too. So the most frequent interval does
    not count.
    """
    between = np.diff(np.flatnonzero(renewed(position)[1:]))
    if between.size < OTHERS:
        return 1
    lengths, counts = np.unique(between, return_counts=True)
    others = between[between != lengths[np.argmax(counts)]]
    if others.size < OTHERS:
        return 1
    for count in range(int(np.median(between)), 1, -1):
        if min(np.mean(of % count == 0) for of in (between, others)) >= MOSTLY:
            return count
    return 1


def _is_quiet_between(force: Array, new: Flags) -> bool:
    """Return whether a force changes much less within readings than from one to the next."""
    change2, at_new = np.diff(force) ** 2, new[1:]
    if min(at_new.sum(), (~at_new).sum()) < FEWEST:
        return False
    within = float(change2[~at_new].mean())
    return 0 < within < QUIET * float(change2[at_new].mean())


def _means_of(force: Array, new: Flags) -> Array:
    """Return the mean of each reading's rows at all of them, (N,)."""
    reading = np.cumsum(new) - 1
    return np.asarray((np.bincount(reading, force) / np.bincount(reading))[reading])


def _moves_with(position: Array, force: Array) -> bool:
    """Return whether a position moves only at samples at which the force differs too."""
    moved = np.diff(position) != 0
    return moved.sum() >= FEWEST and float(np.mean(renewed(force)[1:][moved])) >= MOSTLY


def _readings(position: Array, force: Array) -> Flags:
    """Return the samples at which a held position has a new reading, (N,)."""
    if _jumps(position):
        return _with_equal_readings(renewed(position), held_for(position))
    if held_for(force) > 1 and _moves_with(position, force):
        return _with_equal_readings(renewed(force), held_for(force))
    count, moved = _in_step(position), renewed(position)
    phases = np.bincount(np.flatnonzero(moved[1:]) % count)
    rows = np.arange(-1, position.size - 1)  # before each move
    return np.asarray((rows < 0) | (rows % count == np.argmax(phases)))


def _with_equal_readings(new: Flags, count: int) -> Flags:
    """Return the samples of all readings, also of those that equal the previous one, (N,).

    They are where no new value came for the time of two or more readings. Without them the joint
    would seem to move on evenly where it stood still.

    Parameters
    ----------
    new : ndarray of bool, shape (N,)
        Samples with a new value.
    count : int
        For how many samples a reading is held.
    """
    every = new.copy()
    starts = np.append(np.flatnonzero(new), new.size)
    for start, stop in pairwise(starts.tolist()):
        parts = round((stop - start) / count)
        if parts > 1:
            every[np.round(np.linspace(start, stop, parts, endpoint=False)).astype(np.intp)] = True
    return every


def _jumps(position: Array) -> bool:
    """Return whether a position moves by many counts at a time, unlike a coarse encoder."""
    steps = np.abs(np.diff(position))
    steps = steps[steps > 0]
    return bool(steps.size and np.median(steps) > COUNTS * steps.min())

"""Readings that a log repeats: a slow sensor in a fast log, whose last value is held."""

import numpy as np
import pandas as pd

from bayesfric.arrays import Array, Flags

MOSTLY = 0.9  # of the times between two new readings, that are one number of samples
BUSY = 0.9  # of the samples at which the position changes, that the force changes at too
CAUGHT_UP = 1.5  # usual steps, that a position moves by after a row that was repeated
COUNTS = 3  # of an encoder, that a position that is held moves by at a time, at the least
SENSED = frozenset({"motor", "link", "measured"})  # kinds of force that a sensor reads
ANSWERS = 0.9  # correlation of a force's changes with those of the position, against them
FEWEST = 10  # new readings, by which a rhythm is told


def renewed(values: Array) -> Flags:
    """Return at which samples a reading differs from the one before, (N,); true at the first."""
    return np.concatenate([[True], np.diff(values) != 0])


def held_for(values: Array) -> int:
    """Return how many samples each reading is held for; 1 where it is new at each, or irregular.

    A coarse encoder repeats itself too, where the axis is slow; it has no rhythm. A reading that
    happens to be the same twice makes a multiple of the rhythm, which counts as it.

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
    # A rhythm of some samples and a bit is now one more, now one less.
    off = np.abs(between - rhythm * np.maximum(np.round(between / rhythm), 1))
    steady = (off == 0) if rhythm < 4 else (off <= 1)
    return rhythm if float(np.mean(steady)) >= MOSTLY else 1


def stale(position: Array, force: Array) -> Flags:
    """Return which rows repeat the one before though the axis moved on, shape (N,).

    So telemetry does where a new row is late. A joint that rests repeats its readings too; after
    that it moves by no more than it does from row to row, and not by what it missed.

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

    Where the position is held, the first row of each reading is kept. A measured force that is
    held goes on in a straight line to its next reading. A commanded one acts as it is held. One
    that answers each count of the encoder went on answering; see :func:`answering`. Rows that
    repeat the one before though the axis moved on are left out.

    Parameters
    ----------
    samples : DataFrame
        Of one run, with columns of ``axis_samples.csv``.
    force_is : str or None
        What kind of force was logged, as ``rig.force_is`` has it; None where nobody says.
    """
    position = samples["position_m"].to_numpy(dtype=np.float64)
    force = samples["force_n"].to_numpy(dtype=np.float64)
    position_held = position_held_for(position, force)
    force_held = held_for(force) if force_is in SENSED else 1
    answers = answering(position, force) if position_held == 1 else None
    if answers is not None:
        force_held = held_for(force)
        samples = samples.assign(force_n=answers)
    elif force_held > 1:
        time, new = samples["time_s"].to_numpy(dtype=np.float64), renewed(force)
        samples = samples.assign(force_n=np.interp(time, time[new], force[new]))
    if position_held > 1:
        samples = samples[_readings(position, force)].reset_index(drop=True)
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
    """Return a held force as it went on, where it answers the encoder's counts; None elsewhere.

    A controller's damping kicks at each count. Telemetry that repeats its force for some samples
    shows a kick too few, or one for too long; the counts, which it does not repeat, tell them all.

    Parameters
    ----------
    position, force : ndarray, shape (N,)
        Of evenly sampled rows.
    """
    if held_for(force) == 1:
        return None
    new = np.flatnonzero(renewed(force))
    moved = np.diff(position, prepend=position[0])
    quick_force, quick_move = _quick(force[new]), _quick(moved[new])
    size = float(np.linalg.norm(quick_force) * np.linalg.norm(quick_move))
    along = float(quick_force @ quick_move)
    if size == 0 or along > -ANSWERS * size:
        return None
    kick = along / float(quick_move @ quick_move)
    calm = np.interp(np.arange(force.size), new, force[new] - kick * moved[new])
    return np.asarray(calm + kick * moved)


def _quick(values: Array) -> Array:
    """Return what changes from reading to reading, second differences, of shape (N − 2,)."""
    return np.asarray(np.diff(values, 2))


def position_held_for(position: Array, force: Array) -> int:
    """Return how many samples each position is held for; 1 for a coarse encoder, which is not.

    A coarse encoder moves by few counts at a time and may rest at one. It is held if it moves
    only when the force is read anew: one clock then reads both.

    Parameters
    ----------
    position, force : ndarray, shape (N,)
        Of a run.
    """
    if _jumps(position):
        return held_for(position)
    return held_for(force) if _moves_with(position, force) else 1


def _moves_with(position: Array, force: Array) -> bool:
    """Return whether a position moves only at samples at which the force differs too."""
    moved = np.diff(position) != 0
    return moved.sum() >= FEWEST and float(np.mean(renewed(force)[1:][moved])) >= MOSTLY


def _readings(position: Array, force: Array) -> Flags:
    """Return the samples at which a held position is read anew, (N,)."""
    return renewed(position) if _jumps(position) else renewed(force)


def _jumps(position: Array) -> bool:
    """Return whether a position moves by many counts at a time: no coarse encoder does."""
    steps = np.abs(np.diff(position))
    steps = steps[steps > 0]
    return bool(steps.size and np.median(steps) > COUNTS * steps.min())

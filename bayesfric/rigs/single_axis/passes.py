"""Passes of an axis from one reversal to the next, and its rests; friction may depend on both."""

from itertools import pairwise

import numpy as np

from bayesfric.arrays import Array

REMEMBERED = 4  # earlier passes that friction may depend on


def passes_of(position: Array, way: Array, unseen: float) -> tuple[Array, Array]:
    """Return the travel since the last reversal, and the travel of earlier passes.

    Parameters
    ----------
    position, way : ndarray, shape (N,)
        Position [m or rad], and direction: 1, −1, or 0 if unknown.
    unseen : float
        Travel of a pass that began before the log [m or rad].

    Returns
    -------
    travel : ndarray, shape (N,)
        Travel since the last reversal. Before the first reversal it is `unseen`, or the travel
        from the start of the log if the log begins at rest.
    before : ndarray, shape (N, REMEMBERED)
        Travel of the earlier passes, the latest first.
    """
    moving = np.flatnonzero(way)
    travel = np.full(position.size, unseen)
    before = np.full((position.size, REMEMBERED), unseen)
    if not moving.size:
        return travel, before
    turned = np.flatnonzero(np.diff(way[moving]))
    turns = moving[turned + 1]
    last = np.searchsorted(turns, np.arange(position.size), side="right") - 1
    # A reversal is at the extreme position between two samples of known, opposite directions.
    extremes = np.array(
        [_extreme(position, int(moving[place]), int(moving[place + 1])) for place in turned]
    )
    if way[0] == 0:
        travel = np.abs(position - position[0])
    if extremes.size:
        after_reversal = last >= 0
        travel[after_reversal] = np.abs(position[after_reversal] - extremes[last[after_reversal]])
        strokes = np.concatenate([np.full(REMEMBERED, unseen), np.abs(np.diff(extremes))])
        ago = last[after_reversal, None] - 1 - np.arange(REMEMBERED)
        before[after_reversal] = strokes[np.maximum(ago + REMEMBERED, 0)]
    return travel, before


def rests_of(position: Array, way: Array, interval_s: float) -> tuple[Array, Array]:
    """Return the duration of the last rest before the present motion, and the travel since.

    Parameters
    ----------
    position, way : ndarray, shape (N,)
        Position [m or rad], and direction: 1, −1, or 0 where the axis is not known to move.
    interval_s : float
        Time between samples [s].

    Returns
    -------
    dwell_s, since : ndarray, shape (N,)
        Duration of the last rest before the present motion [s], and the distance from it [m]; 0
        before the first start, and the values of the motion before it during a rest.
    """
    moving = way != 0
    starts = np.flatnonzero(moving[1:] & ~moving[:-1]) + 1
    dwell, since = np.zeros((2, position.size))
    stops = np.flatnonzero(~moving[1:] & moving[:-1]) + 1
    rested_from = np.concatenate([[0], stops])[np.searchsorted(stops, starts)]
    for rested, (begin, end) in zip(rested_from, pairwise([*starts, position.size]), strict=True):
        dwell[begin:end] = (begin - rested) * interval_s
        since[begin:end] = np.abs(position[begin:end] - position[begin])
    return dwell, since


def _extreme(position: Array, before: int, after: int) -> float:
    between = position[before : after + 1]
    middle = 0.5 * (between[0] + between[-1])
    return float(between[np.argmax(np.abs(between - middle))])

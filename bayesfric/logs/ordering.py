"""Corrects the clock of a log, with notes that count the corrections.

Counters that restart are unwrapped. Rows that are slightly out of order are sorted. Rows with the
time of another row are left out. If a clock goes back and stays behind, the log has two pieces:
this is an error, since sorting would mix them.
"""

from dataclasses import dataclass

import numpy as np

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.errors import Fault, InputError

GAP = 3.0  # intervals without a sample that count as a gap
BEHIND = 50  # rows, and intervals, by which a row may be out of order
ACROSS = 0.001  # largest gap at a restart of a counter, over its period
STEPS = 5.0  # largest gap at a restart of a counter, in intervals


@dataclass(frozen=True)
class Series:
    """A quantity and its increasing times, both of shape (N,)."""

    time_s: Array
    value: Array


def unwrapped(
    time_s: Array, first: float, periods_s: tuple[float, ...], first_row: int
) -> tuple[Array, tuple[str, ...]]:
    """Return the unwrapped times of a counter, and notes on the corrections.

    Parameters
    ----------
    time_s : ndarray, shape (N,)
        Since the first row, in the order of the log; NaN for a missing value.
    first : float
        Value of the counter at the first row [s].
    periods_s : tuple of float
        Periods after which it may restart.
    first_row : int
        Number of the first row in notes.
    """
    there = np.flatnonzero(np.isfinite(time_s))
    steps = np.diff(time_s[there])
    interval = _interval(steps)
    if not (steps < 0).any():
        return time_s, ()
    shown = time_s[there] + first
    for period in periods_s:
        across = min(max(STEPS * interval, ACROSS * period), period / 4)
        begins_again = np.abs(steps + period) <= across
        counts = (shown.min() >= 0 and shown.max() < period) or (
            shown.min() >= -period / 2 and shown.max() < period / 2
        )
        if not counts or not begins_again.any():
            continue
        # Rows that are out of order around a restart jump there and back.
        turns = np.cumsum(begins_again.astype(int) - (np.abs(steps - period) <= across))
        turns = np.maximum(turns, 0)
        unwrapped_s = time_s.copy()
        unwrapped_s[there[1:]] += turns * period
        times, row = int(turns.max(initial=0)), int(there[1:][np.argmax(begins_again)]) + first_row
        often = "once" if times == 1 else f"{times} times"
        return unwrapped_s, (
            f"its clock begins again after {period:.10g} s, {often} (first at row {row}): "
            "it is unwrapped",
        )
    return time_s, ()


def in_order(
    time_s: Array, value: Array, file: str, column: str, first_row: int
) -> tuple[Series, tuple[str, ...]]:
    """Return the numbers in order of time (of equal times, the first), and clauses with counts.

    Parameters
    ----------
    time_s, value : ndarray, shape (N,)
        In the order of the log; NaN for a missing value.
    file, column : str
        Names of the log and its clock in an error.
    first_row : int
        Number of the first row in an error.

    Raises
    ------
    InputError
        The clock goes back and stays behind.
    """
    there = np.flatnonzero(np.isfinite(time_s) & np.isfinite(value))
    notes: list[str] = []
    blank = time_s.size - there.size
    if blank:
        notes.append(f"{counted(blank, 'row')} without a number left out")
    times = time_s[there]
    ahead = np.maximum.accumulate(times) if times.size else times
    late = times < ahead
    if late.any():
        _check_behind(times, ahead - times, late, there + first_row, file, column)
        row = int(there[np.argmax(late)]) + first_row
        notes.append(f"{counted(int(late.sum()), 'row')} out of order (first: row {row}) sorted")
    unique, kept = np.unique(times, return_index=True)
    doubled = np.setdiff1d(np.arange(times.size), kept)
    if doubled.size:
        row = int(there[doubled[0]]) + first_row
        notes.append(
            f"{counted(doubled.size, 'row')} with the time of an earlier row (first: row {row}) "
            "left out"
        )
    series = Series(unique, value[there][kept])
    return series, (*notes, *_gap_notes(series))


def gaps_of(series: Series) -> tuple[Array, Array]:
    """Return begin and end of the gaps [s], two arrays of shape (G,)."""
    steps = np.diff(series.time_s)
    wide = np.flatnonzero(steps > GAP * _interval(steps)) if steps.size else np.zeros(0, dtype=int)
    return series.time_s[wide], series.time_s[wide + 1]


def _gap_notes(series: Series) -> tuple[str, ...]:
    begin, end = gaps_of(series)
    if not begin.size:
        return ()
    longest = int(np.argmax(end - begin))
    since = begin[longest] - series.time_s[0]
    return (
        f"no sample for more than {GAP:g} intervals at {counted(begin.size, 'place')}, the longest "
        f"{end[longest] - begin[longest]:.4g} s, {since:.4g} s after the first",
    )


def _check_behind(
    times: Array, behind: Array, late: Flags, rows: Whole, file: str, column: str
) -> None:
    edges = np.flatnonzero(np.diff(late.astype(int), prepend=0, append=0))
    begins, ends = edges[::2], edges[1::2]
    interval = _interval(np.diff(times))
    deepest = np.array([behind[i:j].max() for i, j in zip(begins, ends, strict=True)])
    wrong = np.flatnonzero((ends - begins > BEHIND) | (deepest > BEHIND * interval))
    if wrong.size:
        first = int(begins[wrong[0]])
        rows_behind = counted(int(ends[wrong[0]] - first), "row")
        expected = (
            f"a clock that runs on; it goes back by {behind[first]:.6g} s and "
            f"{rows_behind} from there are behind what came before: "
            "cut the log there, or take a clock that does not start anew"
        )
        raise InputError([Fault(file, expected, int(rows[first]), column)])


def _interval(steps: Array) -> float:
    """Return the median step of a clock; infinite if it never advances."""
    forward = steps[steps > 0]
    return float(np.median(forward)) if forward.size else np.inf


def counted(number: int, noun: str) -> str:
    """Return a number of things in words."""
    return f"1 {noun}" if number == 1 else f"{number:,} {noun}s"

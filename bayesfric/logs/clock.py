"""A clock column of a log to seconds since its first row: counters, stamps of a day, ISO 8601.

Stamps are subtracted as exact decimals, and only the difference becomes a float. Nanoseconds since
1970 have nineteen digits, of which a float keeps sixteen.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date
from decimal import Decimal
from itertools import pairwise

import numpy as np

from bayesfric.arrays import Array
from bayesfric.errors import Fault, InputError
from bayesfric.logs.units import SECONDS

DECIMALS = 9  # decimals of a time in seconds that are kept
NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d{1,2})?", re.ASCII)
OF_DAY = r"(\d{1,2}):(\d\d):(\d\d(?:[.,]\d{1,12})?)"
CLOCK = re.compile(OF_DAY, re.ASCII)
ISO = re.compile(
    rf"(\d{{4}})[-/](\d\d)[-/](\d\d)[T ]{OF_DAY}\s?(Z|UTC|[+-]\d\d(?::?\d\d)?)?",
    re.ASCII | re.IGNORECASE,
)
LONGEST = 48  # longest stamp [characters]
DAY_S = 86400
LATEST_S = 4.2e9  # since 1970: the year 2103
SHORTEST_S = 1e-6  # shortest sample interval of a drive
EXPECTED = "a number, a time of day as 14:46:55.892351 or a date and time of ISO 8601"


@dataclass(frozen=True)
class Stamps:
    """Stamps of one column, exact.

    Parameters
    ----------
    seconds : tuple of Decimal or None
        Stamp of each row; None if the cell is blank.
    periods_s : tuple of float
        Periods after which a clock of this form may restart at zero.
    """

    seconds: tuple[Decimal | None, ...]
    periods_s: tuple[float, ...]

    @property
    def first(self) -> Decimal | None:
        """The first stamp that is not blank."""
        return next((stamp for stamp in self.seconds if stamp is not None), None)


def is_stamp(text: str) -> bool:
    """Return whether a text is a time of day, or a date and time of ISO 8601."""
    return bool(CLOCK.fullmatch(text) or ISO.fullmatch(text))


def stamps_of(
    cells: Sequence[str | None], unit: str, file: str, column: str, first_row: int
) -> Stamps:
    """Return the stamps of a column.

    Parameters
    ----------
    cells : sequence of str or None
        Cells as written; None or blank if there is no stamp.
    unit : str
        Unit of numbers: a key of :data:`bayesfric.logs.units.SECONDS`. Times of day and ISO 8601
        need no unit.
    file, column : str
        Their names in an error.
    first_row : int
        Number of the first row in an error.

    Raises
    ------
    InputError
        A cell has none of the three forms, forms are mixed, or the unit is implausible.
    """
    texts = ["" if cell is None else cell.strip() for cell in cells]
    sample = next((text for text in texts if text), "")
    read, periods = _number, _counter_periods(unit)
    if CLOCK.fullmatch(sample):
        read, periods = _time_of_day, (float(DAY_S),)
    elif ISO.fullmatch(sample):
        read, periods = _iso, ()
    scale = Decimal(repr(SECONDS[unit])) if read is _number else Decimal(1)
    stamps: list[Decimal | None] = []
    wrong: list[int] = []
    is_whole = True
    for row, text in enumerate(texts):
        value = read(text) if text and len(text) <= LONGEST else None
        if text and value is None:
            wrong.append(row)
        is_whole = is_whole and (value is None or value == value.to_integral_value())
        stamps.append(None if value is None else value * scale)
    if wrong:
        place, like = wrong[0] + first_row, len(wrong) - 1
        raise InputError([Fault(file, EXPECTED, place, column, texts[wrong[0]], like)])
    if read is _number:
        if not is_whole:
            periods = ()  # counters have whole numbers only
        _check_unit(stamps, unit, file, column)
    return Stamps(tuple(stamps), periods)


def seconds_since(stamps: Stamps, origin: Decimal) -> Array:
    """Return seconds since a stamp, rounded to nanoseconds; NaN for a blank cell, shape (N,)."""
    since = [float("nan") if stamp is None else float(stamp - origin) for stamp in stamps.seconds]
    return np.asarray(np.round(np.array(since, dtype=np.float64), DECIMALS))


def _counter_periods(unit: str) -> tuple[float, ...]:
    """Return the periods, in seconds, after which counters of 16, 24 and 32 bits restart.

    A counter of microseconds or nanoseconds may have been divided to whole numbers before it was
    written. Numbers with decimals are no counter.
    """
    ticks = sorted(tick for tick in SECONDS.values() if tick <= SECONDS[unit])
    return tuple(sorted({2.0**bits * tick for bits in (16, 24, 32) for tick in ticks}))


def _number(text: str) -> Decimal | None:
    return Decimal(text) if NUMBER.fullmatch(text) else None


def _time_of_day(text: str) -> Decimal | None:
    match = CLOCK.fullmatch(text)
    return None if match is None else _day_seconds(*match.groups())


def _day_seconds(hours: str, minutes: str, seconds: str) -> Decimal | None:
    second = Decimal(seconds.replace(",", "."))
    if int(hours) > 23 or int(minutes) > 59 or second > 60:  # 60 is a leap second
        return None
    return 3600 * int(hours) + 60 * int(minutes) + second


def _iso(text: str) -> Decimal | None:
    match = ISO.fullmatch(text)
    if match is None:
        return None
    year, month, day, hours, minutes, seconds, zone = match.groups()
    since = _day_seconds(hours, minutes, seconds)
    try:
        days = date(int(year), int(month), int(day)).toordinal()
    except ValueError:
        return None
    if since is None:
        return None
    ahead = 0
    if zone is not None and zone[0] in "+-":
        digits = zone[1:].replace(":", "").ljust(4, "0")
        ahead = int(f"{zone[0]}1") * (3600 * int(digits[:2]) + 60 * int(digits[2:]))
    return DAY_S * days + since - ahead


def _check_unit(stamps: Sequence[Decimal | None], unit: str, file: str, column: str) -> None:
    """Refuse a unit in which a clock is beyond the year 2100, or faster than any logger."""
    there = [stamp for stamp in stamps if stamp is not None]
    if len(there) < 2:
        return
    first = float(there[0])
    steps = np.abs(np.array([float(b - a) for a, b in pairwise(there)]))
    moved = steps[steps > 0]
    interval = float(np.median(moved)) if moved.size else 1.0
    if abs(first) <= LATEST_S and interval >= SHORTEST_S:
        return
    since_1970 = [
        other
        for other, seconds in SECONDS.items()
        if 1e9 < abs(first) / SECONDS[unit] * seconds < LATEST_S
    ]
    expected = "the unit of the clock"
    if since_1970:
        expected += f"; is {since_1970[0]} since 1970 meant?"
    value = f"{unit}, in which a sample comes every {interval:.3g} s, the first at {first:.6g} s"
    raise InputError([Fault(file, expected, column=f"time.unit of {column}", value=value)])

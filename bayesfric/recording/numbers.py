"""The rule for numbers as text, and common mistakes in cells that should be numbers.

A number has digits 0 to 9, a point, an exponent. Every pattern here takes a time that is linear in
the length of a cell, so a file with one long cell causes no delay.
"""

import re
from collections.abc import Iterable
from contextlib import suppress

import numpy as np
import pandas as pd

from bayesfric.arrays import Array

_DECIMAL = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_OF_DECIMALS = b"0123456789.eE+-"
_BLANK = " \N{NO-BREAK SPACE}\N{THIN SPACE}\N{NARROW NO-BREAK SPACE}"
SAMPLED, REPEATED = 10_000, 0.1
"""Number of cells that are examined for repetition, and the share of distinct ones below which each
distinct cell is read only once."""
LONGEST_CAUSE = 100  # longest cell [characters] in which a cause is searched for

COMMA = ", with a point as the decimal mark"
THOUSANDS = ", without a separator of thousands"
EITHER = ", with a point as the decimal mark and without a separator of thousands"
CLOCK = " (is it a time of day, or a date? Write the seconds since the first row)"

_CAUSES = (
    (re.compile(rf"[+-]?\d{{1,3}}([{_BLANK}'’]\d{{3}})+([.,]\d*)?", re.ASCII), THOUSANDS),
    (re.compile(r"[+-]?\d{1,3}(,\d{3})+\.\d*|[+-]?\d{1,3}(,\d{3}){2,}", re.ASCII), THOUSANDS),
    (re.compile(r"[+-]?[1-9]\d{0,2},\d{3}", re.ASCII), EITHER),
    (re.compile(r"[+-]?(\d*|\d{1,3}(\.\d{3})+),\d+([eE][+-]?\d+)?", re.ASCII), COMMA),
    (re.compile(".*\N{MINUS SIGN}.*"), ", with a hyphen as the minus sign"),
    (re.compile("true|false", re.I), " (a spreadsheet's TRUE or FALSE is no number)"),
    (
        re.compile(
            r"(\d{4}-?\d\d-?\d\d[T ])?\d{1,2}:\d\d(:\d\d([.,]\d*)?)? ?(Z|[AP]M|[+-]\d\d(:?\d\d)?)?"
            r"|\d{4}-\d\d-\d\dT\d.*",
            re.ASCII | re.I,
        ),
        CLOCK,
    ),
    (
        re.compile(
            r"\d{1,4}([-/.])\d{1,2}\1\d{1,4}.*"
            r"|.*\b(jan|feb|mar|apr|may|jun|jul|aug|sep|oct|nov|dec)[a-z]*\b.*",
            re.ASCII | re.I,
        ),
        " (has a spreadsheet made a date of it?)",
    ),
    (
        re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?[ \t]*[a-zA-Zµμ°%·/²³]+"),
        ", without its unit, which stands in the column's name",
    ),
)
"""Common mistakes, and what is said of a cell that matches; the first that does counts."""


def is_decimal(cell: str) -> bool:
    """Return whether a text is a decimal number of ASCII digits, finite or not."""
    return _DECIMAL.fullmatch(cell) is not None


def to_numbers(cells: pd.Series) -> pd.Series:
    """Return finite decimal numbers; NaN for everything else, including "nan" and "inf".

    Parameters
    ----------
    cells : Series of str
        Texts without surrounding blanks.
    """
    if cells.iloc[:SAMPLED].nunique() < REPEATED * min(SAMPLED, len(cells)):
        code, words = pd.factorize(cells)
        return pd.Series(_numbers(pd.Series(words)).to_numpy()[code], index=cells.index)
    return _numbers(cells)


def _numbers(cells: pd.Series) -> pd.Series:
    # Without other characters, all numbers that Python reads are decimal.
    if not "".join(cells.tolist()).encode().translate(None, _OF_DECIMALS):
        with suppress(ValueError):
            return _finite(cells)
    return _finite(cells.map(lambda cell: cell if is_decimal(cell) else "nan"))


def _finite(cells: pd.Series) -> pd.Series:
    numbers = cells.to_numpy(dtype=object).astype(np.float64)
    numbers[~np.isfinite(numbers)] = np.nan
    return pd.Series(numbers, index=cells.index)


def to_numbers_apart(cell: str) -> Array:
    """Return the numbers of a cell, separated by blanks, shape (N,); NaN for other parts."""
    return to_numbers(pd.Series(cell.split(), dtype=object)).to_numpy()


def cause_of(cell: str) -> str | None:
    """Return a hint why a cell is no number; None if the cause is not recognised."""
    if len(cell) > LONGEST_CAUSE:
        return None
    return next((hint for pattern, hint in _CAUSES if pattern.fullmatch(cell)), None)


def one_cause(hints: Iterable[str]) -> dict[str, str]:
    """Return the hint for each cause; an ambiguous ``1,234`` gets that of the other cells.

    Parameters
    ----------
    hints : iterable of str
        As :func:`cause_of` returns them, of one table.
    """
    causes = set(hints)
    sure = [cause for cause in (COMMA, THOUSANDS) if cause in causes]
    return {cause: sure[0] if cause == EITHER and len(sure) == 1 else cause for cause in causes}

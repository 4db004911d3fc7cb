"""Text cells → typed columns, checked one cell at a time.

A cell that is no number becomes NaN, and NaN is what the rules then refuse, so
that every fault keeps its line and its value as written.
"""

import re
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pandas as pd

from bayesfric.errors import Fault, InputError, near
from bayesfric.recording.columns import LARGEST, TABLES, Column, TableFormat
from bayesfric.recording.csv_text import TextTable

__all__ = ["Table", "check_cells"]

DECIMAL = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)

OF_DECIMALS = b"0123456789.eE+-"

NO_NUMBERS = {
    r"[+-]?\d+,\d+": ", with a point as the decimal mark",
    ".*\N{MINUS SIGN}.*": ", with a hyphen as the minus sign",
    "(?i:true|false)": " (a spreadsheet's answer to a comparison is none)",
    r"\d{1,4}([-/.])\d{1,2}\1\d{1,4}.*|(?i:.*\b(jan|feb|mar|apr|may|jun|jul|aug|sep|oct|nov|dec)"
    r"[a-z]*\b.*)": " (has a spreadsheet made a date of it?)",
}
"""What stands where a number belongs, and what is said of it."""
SEARCHED = 1000  # cells that are searched for one
NOTED = 10  # columns that are named where more are kept out

CONTROL_CHARACTER = re.compile(r"[\x00-\x1f\x7f-\x9f]")
TYPOGRAPHIC = re.compile("[“”„‘’‚«»].*[“”„‘’‚«»]")


@dataclass(frozen=True)
class Table:
    """A table whose cells were checked one by one.

    Parameters
    ----------
    format : TableFormat
        The rules it was checked against.
    text : TextTable
        As written.
    frame : DataFrame
        The same rows as `text`, known columns only, in canonical order. A cell at
        fault, or empty, is NaN, so that no further rule stumbles over it; integers are
        still floats, and words that repeat are categories.
    faults : tuple of Fault
        Everything wrong with single cells, columns and ids.
    notes : tuple of str
        Columns that were kept out.
    """

    format: TableFormat
    text: TextTable
    frame: pd.DataFrame
    faults: tuple[Fault, ...]
    notes: tuple[str, ...]

    def has(self, *columns: str) -> bool:
        """Whether all of these columns are there."""
        return all(column in self.frame for column in columns)

    def faults_where(self, mask: npt.ArrayLike, column: str, expected: str) -> list[Fault]:
        """One fault, at `column`, for each row in which `mask` is true."""
        return self.text.faults_at(np.flatnonzero(mask), column, expected)


def check_cells(text: TextTable, table: TableFormat) -> Table:
    """Type the columns of a table and collect the faults of its cells.

    An optional column without a single entry counts as absent.

    Parameters
    ----------
    text : TextTable
        The cells.
    table : TableFormat
        The rules.

    Raises
    ------
    InputError
        If the header has no column of the table or is that of another, or if the row below
        it holds units.
    """
    _check_header(text, table)
    _check_units(text, table)
    known: dict[str, pd.Series] = {}
    for column in table.columns:
        if column.name in text.cells:
            cells = text.cells[column.name]
            if column.required or (cells != "").any():
                known[column.name] = _typed(cells, column)
    notes = []
    if text.unnamed:
        notes.append(f"{text.file}: {text.unnamed} column(s) without a name kept out")
    names = [column.name for column in table.columns]
    absent = [name for name in names if name not in text.cells]
    kept_out = []
    for name in text.cells.columns.difference(names, sort=False):
        numbers = _numbers(text.cells[name]) if table.keeps_covariates else None
        if numbers is not None and (numbers.abs() <= LARGEST).all():
            known[str(name)] = numbers
        else:
            kept_out.append(str(name))
    why = " (not a number in every row)" if table.keeps_covariates else ""
    for name in kept_out[:NOTED]:
        notes.append(f"{text.file}: unknown column {name!r} kept out{why}{near(name, absent)}")
    if len(kept_out) > NOTED:
        rest = len(kept_out) - NOTED
        notes.append(f"{text.file}: and {rest:,} unknown columns more kept out{why}")
    frame = pd.DataFrame(known, index=text.cells.index)
    frame, faults = _checked(frame, text, table)
    return Table(table, text, frame, (*text.faults, *faults), tuple(notes))


def _check_header(text: TextTable, table: TableFormat) -> None:
    names = {column.name for column in table.columns}
    written = [str(name) for name in text.cells.columns]
    needed = [column.name for column in table.columns if column.required]
    shared = {
        file: len(set(written) & {column.name for column in other.columns})
        for file, other in TABLES.items()
    }
    likest = max(shared, key=lambda file: shared[file])
    if not set(needed) <= set(written) and shared[likest] > len(names & set(written)):
        expected = f"the columns {', '.join(needed)} (is this {likest}?)"
        raise InputError([Fault(text.file, expected, row=1, value=",".join(written))])
    if names & set(written):
        return
    expected = f"a header with {', '.join(needed)} (is there none?)"
    if {name.lower() for name in written} & names:
        expected = f"columns in small letters: {', '.join(needed)}"
    raise InputError([Fault(text.file, expected, row=1, value=",".join(written))])


def _check_units(text: TextTable, table: TableFormat) -> None:
    """Refuse a row of units: words where numbers belong, and numbers below them."""
    numeric = [c.name for c in table.columns if c.is_numeric and c.name in text.cells]
    first, *below = text.cells[numeric].head(2).to_numpy().tolist()
    words = [cell[:1].isalpha() or cell in ("-", "%", "°") for cell in first]
    numbers = [bool(DECIMAL.fullmatch(cell)) for row in below for cell in row]
    if len(words) > 1 and all(words) and any(numbers):
        expected = "numbers below the header (are these units? take the row out)"
        raise InputError(
            [Fault(text.file, expected, row=int(text.lines[0]), value=",".join(first))]
        )


def _typed(cells: pd.Series, column: Column) -> pd.Series:
    if not column.is_numeric:
        if not column.repeats:
            return cells.where(cells != "", np.nan).astype("str")
        words = cells.astype("category")
        return words.cat.remove_categories([word for word in words.cat.categories if not word])
    numbers = _numbers(cells)
    if column.kind == "integer":
        numbers = numbers.where(numbers == np.floor(numbers))
    return numbers


def _numbers(cells: pd.Series) -> pd.Series:
    """Finite decimal numbers; NaN for all else, "nan" and "inf" included."""
    # Where no other characters are, what Python reads as numbers are decimal ones.
    if not "".join(cells.tolist()).encode().translate(None, OF_DECIMALS):
        with suppress(ValueError):
            return _finite(cells)
    return _finite(cells.map(lambda cell: cell if DECIMAL.fullmatch(cell) else "nan"))


def _finite(cells: pd.Series) -> pd.Series:
    numbers = cells.to_numpy(dtype=object).astype(np.float64)
    numbers[~np.isfinite(numbers)] = np.nan
    return pd.Series(numbers, index=cells.index)


def _checked(
    frame: pd.DataFrame, text: TextTable, table: TableFormat
) -> tuple[pd.DataFrame, list[Fault]]:
    """Blank the cells that break their column's rule, and say which they were."""
    faults: list[Fault] = []
    names = {column.name for column in table.columns}
    written = [str(name) for name in text.cells.columns if name not in names]
    for column in table.columns:
        name = column.name
        if name not in frame:
            if column.required:
                expected = f"this column, each cell {column.expected}{near(name, written)}"
                faults.append(Fault(text.file, expected, row=1, column=name))
            continue
        values, cells = frame[name], text.cells[name]
        wrong = values.isna() | ~_obeys(values, column)
        if wrong.any():
            excused = (cells == "") & (column.may_be_empty or cells.index.isin(list(text.ragged)))
            if (positions := np.flatnonzero(wrong & ~excused)).size:
                faults += text.faults_at(positions, name, _expected(column, cells, values))
        if column.unique:
            repeated = values.duplicated() & ~wrong
            positions = np.flatnonzero(repeated)
            faults += text.faults_at(positions, name, "a value that no other row has")
        if wrong.any():
            frame = frame.assign(**{name: values.mask(wrong)})
    return frame, faults


def _expected(column: Column, cells: pd.Series, values: pd.Series) -> str:
    if column.kind == "number" and (values.abs() > LARGEST).any():
        return f"{column.expected}, of {LARGEST:g} at most in size"
    for pattern, hint in NO_NUMBERS.items() if column.is_numeric else ():
        if any(re.fullmatch(pattern, cell, re.ASCII) for cell in cells.head(SEARCHED)):
            return column.expected + hint
    if column.is_text and any(TYPOGRAPHIC.fullmatch(cell) for cell in cells.head(SEARCHED)):
        return f'{column.expected}, in " or in no quotation marks (these are typographic)'
    return column.expected


def _obeys(values: pd.Series, column: Column) -> "pd.Series[bool]":
    """Whether each value that is there obeys the rules of its column."""
    obeys = pd.Series(True, index=values.index)
    if column.is_text:
        # Ids repeat: looking at each once is faster by far.
        each = values.dropna().unique()
        obeys &= ~values.isin([c for c in each if CONTROL_CHARACTER.search(c)])
        obeys &= ~values.isin([c for c in each if TYPOGRAPHIC.fullmatch(c)])
    if column.kind == "choice":
        obeys &= values.isin(column.choices)
    if column.kind == "number":
        obeys &= values.abs() <= LARGEST
    if column.kind == "integer":
        obeys &= (values >= 1) & (values <= column.largest)
    if column.above is not None:
        obeys &= values > column.above
    if column.least is not None:
        obeys &= values >= column.least
    if column.most is not None:
        obeys &= values <= column.most
    if column.nonzero:
        obeys &= values != 0
    return obeys

"""Text cells → typed columns, checked one cell at a time with pandera.

A cell that is no number becomes NaN, and NaN is what the schema then refuses, so
that every fault keeps its line and its value as written.
"""

import re
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
import pandas as pd

from bayesfric.errors import Fault
from bayesfric.recording.columns import LARGEST_INTEGER, Column, TableFormat
from bayesfric.recording.csv_text import TextTable

if TYPE_CHECKING:
    from pandera.pandas import Check, DataFrameSchema, Hypothesis

__all__ = ["Table", "check_cells"]

DECIMAL = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)

CONTROL_CHARACTER = re.compile(r"[\x00-\x1f\x7f-\x9f]")


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
        still floats.
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
        return self.text.faults_at(np.flatnonzero(mask).tolist(), column, expected)


def check_cells(text: TextTable, table: TableFormat) -> Table:
    """Type the columns of a table and collect the faults of its cells.

    An optional column without a single entry counts as absent.

    Parameters
    ----------
    text : TextTable
        The cells.
    table : TableFormat
        The rules.
    """
    known: dict[str, pd.Series] = {}
    for column in table.columns:
        if column.name in text.cells:
            cells = text.cells[column.name]
            if column.required or (cells != "").any():
                known[column.name] = _typed(cells, column)
    notes = []
    if text.unnamed:
        notes.append(f"{text.file}: {text.unnamed} column(s) without a name kept out")
    names = {column.name for column in table.columns}
    for name in text.cells.columns.difference(list(names), sort=False):
        numbers = _numbers(text.cells[name])
        if table.keeps_covariates and not numbers.isna().any():
            known[str(name)] = numbers
        else:
            why = " (not a number in every row)" if table.keeps_covariates else ""
            notes.append(f"{text.file}: unknown column {name!r} kept out{why}")
    frame = pd.DataFrame(known, index=text.cells.index)
    frame, faults = _checked(frame, text, table)
    return Table(table, text, frame, (*text.faults, *faults), tuple(notes))


def _typed(cells: pd.Series, column: Column) -> pd.Series:
    if not column.is_numeric:
        return cells.where(cells != "", np.nan).astype("str")
    numbers = _numbers(cells)
    if column.kind == "integer":
        numbers = numbers.where(numbers == np.floor(numbers))
    return numbers


def _numbers(cells: pd.Series) -> pd.Series:
    """Finite decimal numbers; NaN for all else, "nan" and "inf" included."""
    decimal = [cell if DECIMAL.fullmatch(cell) else "nan" for cell in cells]
    numbers = np.array(decimal, dtype=object).astype(np.float64)
    numbers[~np.isfinite(numbers)] = np.nan
    return pd.Series(numbers, index=cells.index)


def _checked(
    frame: pd.DataFrame, text: TextTable, table: TableFormat
) -> tuple[pd.DataFrame, list[Fault]]:
    """Blank the cells that break their column's rule, and say which they were."""
    from pandera.errors import SchemaErrors

    try:
        return _schema(table).validate(frame, lazy=True), []
    except SchemaErrors as error:
        cases = error.failure_cases
    faults: list[Fault] = []
    missing = set(cases.loc[cases["check"] == "column_in_dataframe", "failure_case"])
    cells = cases[cases["index"].notna()]
    for column in table.columns:
        name = column.name
        if name in missing:
            expected = f"this column, each cell {column.expected}"
            faults.append(Fault(text.file, expected, row=1, column=name))
        if name not in frame:
            continue
        of_column = cells[cells["column"] == name]
        repeats = of_column["check"] == "field_uniqueness"
        wrong = _positions(of_column[~repeats])
        repeated = _positions(of_column[repeats]) - wrong
        # An empty cell is NaN like one that is no number; what is written tells them apart.
        empty = set(np.flatnonzero(text.cells[name] == "")) if wrong else set()
        excused = empty if column.may_be_empty else empty & text.ragged
        faults += text.faults_at(sorted(wrong - excused), name, column.expected)
        faults += text.faults_at(sorted(repeated), name, "a value that no other row has")
        if wrong:
            frame = frame.assign(**{name: frame[name].mask(frame.index.isin(list(wrong)))})
    return frame, faults


def _is_printable(cells: pd.Series) -> "pd.Series[bool]":
    # Ids repeat: looking at each once is faster by far.
    return ~cells.isin([cell for cell in cells.unique() if CONTROL_CHARACTER.search(cell)])


def _positions(cases: pd.DataFrame) -> set[int]:
    return set(cases["index"].astype(int))


@lru_cache
def _schema(table: TableFormat) -> "DataFrameSchema":
    from pandera.pandas import Column as Rule
    from pandera.pandas import DataFrameSchema

    rules = {
        column.name: Rule(
            checks=_checks(column),
            # An optional empty cell is NaN too; _checked lets it pass.
            nullable=False,
            unique=column.unique,
            report_duplicates="exclude_first",
            required=column.required,
        )
        for column in table.columns
    }
    return DataFrameSchema(rules)


def _checks(column: Column) -> "list[Check | Hypothesis]":
    from pandera.pandas import Check

    checks: list[Check | Hypothesis] = []
    if column.kind in ("id", "text"):
        checks.append(Check(_is_printable))
    if column.kind == "choice":
        checks.append(Check.isin(column.choices))
    if column.kind == "integer":
        checks.append(Check.in_range(1, LARGEST_INTEGER))
    if column.above is not None:
        checks.append(Check.gt(column.above))
    if column.least is not None:
        checks.append(Check.ge(column.least))
    if column.most is not None:
        checks.append(Check.le(column.most))
    if column.nonzero:
        checks.append(Check.ne(0))
    return checks

"""Text cells → typed columns, checked one cell at a time.

A cell that is no number becomes NaN, which the rules then refuse. So every fault keeps
its line and its value as written.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import pandas as pd

from bayesfric.characters import invisible_in
from bayesfric.errors import Fault, InputError, near
from bayesfric.recording.columns import (
    HOTTEST_C,
    LARGEST,
    LONGEST_NAME,
    OTHER_NAMES,
    TABLES,
    TAKEN,
    Column,
    TableFormat,
)
from bayesfric.recording.csv_text import LISTED, TextTable, with_more, with_rest
from bayesfric.recording.numbers import cause_of, is_decimal, one_cause, to_numbers

NOTED = 10  # most columns that a note on ignored columns names

TYPOGRAPHIC = re.compile("[“”„‘’‚«»].*[“”„‘’‚«»]")
QUOTED = ', in " or in no quotation marks (these are typographic)'


@dataclass(frozen=True)
class Table:
    """A table whose cells were checked one by one.

    Parameters
    ----------
    format : TableFormat
        The rules it was checked against.
    text : TextTable
        The cells as written.
    frame : DataFrame
        The same rows as `text`, known columns only, in canonical order. A faulty or empty
        cell is NaN, so that no further rule reports it again. Integers are still floats, and
        words that repeat are categories.
    faults : tuple of Fault
        All faults of single cells, columns and ids.
    notes : tuple of str
        Notes on columns that are ignored.
    """

    format: TableFormat
    text: TextTable
    frame: pd.DataFrame
    faults: tuple[Fault, ...]
    notes: tuple[str, ...]

    def has(self, *columns: str) -> bool:
        """Whether the table has all of these columns."""
        return all(column in self.frame for column in columns)

    def faults_where(self, mask: npt.ArrayLike, column: str, expected: str) -> list[Fault]:
        """One fault, at `column`, for each row in which `mask` is true."""
        return self.text.faults_at(np.flatnonzero(mask), column, expected)

    def first_where(self, mask: npt.ArrayLike, column: str, expected: str) -> list[Fault]:
        """One fault, at `column`, for the first row with a true `mask`; it counts the others."""
        return self.text.faults_at(np.flatnonzero(mask), column, expected, most=1)


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
        If the header has no column of the table or is the header of another table, or if the
        row below it has units.
    """
    _check_names(text)
    text = _by_names_of(text, table)
    _check_header(text, table)
    _check_units(text, table)
    typed_columns: dict[str, pd.Series] = {}
    ragged = text.is_ragged
    for column in table.columns:
        if column.name in text.cells:
            cells = text.cells[column.name]
            if ragged.any() and column.is_numeric:
                cells = cells.mask(ragged, "")  # a cell that may be shifted is not judged
            if column.required or (cells != "").any():
                typed_columns[column.name] = _typed(cells, column)
    notes = []
    if text.unnamed:
        notes.append(f"{text.file}: {text.unnamed} column(s) without a name kept out")
    absent = [name for name in table.names if name not in text.cells]
    kept_out = []
    for name in text.cells.columns.difference(table.names, sort=False):
        if table.keeps_covariates and name in TAKEN:
            notes.append(
                f"{text.file}: column {name!r} kept out (results have this name: rename it)"
            )
            continue
        numbers = to_numbers(text.cells[name]) if table.keeps_covariates else None
        if numbers is not None and ((numbers.abs() <= LARGEST) | ragged).all():
            typed_columns[str(name)] = numbers
        else:
            kept_out.append(str(name))
    why = " (not a number in every row)" if table.keeps_covariates else ""
    for name in kept_out[:NOTED]:
        notes.append(f"{text.file}: unknown column {name!r} kept out{why}{near(name, absent)}")
    if len(kept_out) > NOTED:
        rest = len(kept_out) - NOTED
        notes.append(f"{text.file}: and {rest:,} unknown columns more kept out{why}")
    frame = pd.DataFrame(typed_columns, index=text.cells.index)
    frame, faults = _checked(frame, text, table)
    return Table(table, text, frame, (*text.faults, *faults), tuple(notes))


def _check_names(text: TextTable) -> None:
    """Refuse column names that are too long or contain invisible characters."""
    faults = []
    for name in map(str, text.cells.columns):
        if len(name) > LONGEST_NAME:
            expected = f"a column name of at most {LONGEST_NAME} characters, not {len(name):,}"
        elif unseen := invisible_in(name):
            expected = f"a column name that can be seen{unseen}"
        else:
            continue
        faults.append(Fault(text.file, expected, row=1, value=name))
    if faults:
        raise InputError(with_rest(faults[:LISTED], len(faults[LISTED:])))


def _by_names_of(text: TextTable, table: TableFormat) -> TextTable:
    """Return a table with alternative column names replaced by those of the format.

    Raises
    ------
    InputError
        The table has a column under both names.
    """
    others = {o: n for o, n in OTHER_NAMES.items() if o in text.cells and n in table.names}
    if twice := [other for other, name in others.items() if name in text.cells]:
        raise InputError(
            [Fault(text.file, f"{OTHER_NAMES[o]} or {o}, not both", 1, o) for o in twice]
        )
    if not others:
        return text
    written = {name: other for other, name in others.items()}
    return replace(text, cells=text.cells.rename(columns=others), written=written)


def _check_header(text: TextTable, table: TableFormat) -> None:
    names = set(table.names)
    written = [str(name) for name in text.cells.columns]
    needed = [column.name for column in table.columns if column.required]
    shared = {file: len(set(written) & set(other.names)) for file, other in TABLES.items()}
    likest = max(shared, key=lambda file: shared[file])
    if not set(needed) <= set(written) and shared[likest] > len(names & set(written)):
        expected = f"the columns {', '.join(needed)} (is this {likest}?)"
        raise InputError([Fault(text.file, expected, row=1, value=",".join(written))])
    if names & set(written):
        return
    expected = f"a header with {', '.join(needed)} (is there none?)"
    if {name.lower() for name in written} & names:
        expected = f"column names in lower case: {', '.join(needed)}"
    raise InputError([Fault(text.file, expected, row=1, value=",".join(written))])


def _check_units(text: TextTable, table: TableFormat) -> None:
    """Refuse a row of units: words in number columns, with numbers in the rows below."""
    numeric = [c.name for c in table.columns if c.is_numeric and c.name in text.cells]
    first, *below = text.cells[numeric].head(2).to_numpy().tolist()
    words = [cell[:1].isalpha() or cell in ("-", "%", "°") for cell in first]
    numbers = [is_decimal(cell) for row in below for cell in row]
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
    numbers = to_numbers(cells)
    if column.kind == "integer":
        numbers = numbers.where(numbers == np.floor(numbers))
    return numbers


def _checked(
    frame: pd.DataFrame, text: TextTable, table: TableFormat
) -> tuple[pd.DataFrame, list[Fault]]:
    """Return the frame without the cells that break their column's rule, and their faults."""
    faults: list[Fault] = []
    slips: dict[str, list[tuple[int, Column]]] = {}
    written = [str(name) for name in text.cells.columns if name not in table.names]
    for column in table.columns:
        name = column.name
        if name not in frame:
            if column.required:
                expected = f"this column, each cell {column.expected}{near(name, written)}"
                faults.append(Fault(text.file, expected, row=1, column=name))
            continue
        values, cells = frame[name], text.cells[name]
        wrong = values.isna().to_numpy() | ~_obeys(values, column)
        if wrong.any():
            excused = np.asarray(text.is_ragged | ((cells == "") & column.may_be_empty))
            positions = _without_cause(np.flatnonzero(wrong & ~excused), cells, column, slips)
            faults += _unlike(text, positions, values, column)
        if column.unique:
            repeated = values.duplicated() & ~wrong
            positions = np.flatnonzero(repeated)
            faults += text.faults_at(positions, name, "a value that no other row has")
        if wrong.any():
            frame = frame.assign(**{name: values.mask(wrong)})
    return frame, faults + _slips(text, slips)


def _without_cause(
    positions: npt.NDArray[np.intp],
    cells: pd.Series,
    column: Column,
    slips: dict[str, list[tuple[int, Column]]],
) -> npt.NDArray[np.intp]:
    """Return the rows of unrecognised mistakes; recognised mistakes are added to `slips`."""
    wrong = cells.iloc[positions]
    cause_of_cell = {cell: _cause(cell, column) for cell in wrong.unique()}
    has_cause = np.zeros(positions.size, dtype=np.bool_)
    for place, (position, cell) in enumerate(zip(positions.tolist(), wrong, strict=True)):
        if (cause := cause_of_cell[cell]) is not None:
            slips.setdefault(cause, []).append((position, column))
            has_cause[place] = True
    return positions[~has_cause]


def _cause(cell: str, column: Column) -> str | None:
    if column.is_numeric:
        return None if is_decimal(cell) else cause_of(cell)
    return QUOTED if column.is_text and TYPOGRAPHIC.fullmatch(cell) else None


def _slips(text: TextTable, slips: Mapping[str, Sequence[tuple[int, Column]]]) -> list[Fault]:
    """Return one fault for each recognised mistake, since a file often repeats it in many cells."""
    joined: dict[str, list[tuple[int, Column]]] = {}
    for cause, cause_told in one_cause(slips).items():
        joined.setdefault(cause_told, []).extend(slips[cause])
    faults: list[Fault] = []
    for cause, cells in sorted(joined.items()):
        position, column = min(cells, key=lambda cell: cell[0])
        first = text.faults_at([position], column.name, column.expected + cause)
        faults += with_rest(first, len(cells) - 1)
    return faults


def _unlike(
    text: TextTable, positions: npt.NDArray[np.intp], values: pd.Series, column: Column
) -> list[Fault]:
    """Return the faults of cells whose mistake is not recognised."""
    if column.is_text:
        return _unlike_names(text, positions, column)
    if column.name == "temperature_c" and (values > HOTTEST_C).mean() > 0.5:
        expected = f"{column.expected} (is it in kelvin?)"
        return with_rest(text.faults_at(positions[:1], column.name, expected), len(positions) - 1)
    too_large = column.kind == "number" and (values.abs() > LARGEST).any()
    expected = f", of {LARGEST:g} at most in size" if too_large else ""
    return text.faults_at(positions, column.name, column.expected + expected)


def _unlike_names(text: TextTable, positions: npt.NDArray[np.intp], column: Column) -> list[Fault]:
    """Return one fault for each unusable name, however many rows have it."""
    cells = text.cells[column.name].iloc[positions]
    first = ~cells.duplicated().to_numpy()
    rows = cells.value_counts()
    faults = []
    for position in positions[first][:LISTED].tolist():
        name = text.cells[column.name].iloc[position]
        expected = column.expected + _why_no_name(name, column)
        faults += with_rest(text.faults_at([position], column.name, expected), int(rows[name]) - 1)
    return with_more(faults, len(cells) - sum(1 + fault.like for fault in faults))


def _why_no_name(name: str, column: Column) -> str:
    """Return the invisible character of a name, by its code, or the length of the name."""
    if len(name) > column.longest:
        return f", not {len(name):,}"
    return invisible_in(name)


def _obeys(values: pd.Series, column: Column) -> npt.NDArray[np.bool_]:
    """Whether each value that is not missing obeys the rules of its column."""
    obeys = np.ones(len(values), dtype=np.bool_)
    if column.is_text:
        # Ids repeat: checking each id once is much faster.
        names = values.dropna().unique()
        obeys &= ~values.isin([name for name in names if not _is_name(name, column)]).to_numpy()
    if column.kind == "choice":
        obeys &= values.isin(column.choices).to_numpy()
    if not column.is_numeric:
        return obeys
    numbers = values.to_numpy()
    if column.kind == "number":
        obeys &= np.abs(numbers) <= LARGEST
    if column.kind == "integer":
        obeys &= (numbers >= 1) & (numbers <= column.largest)
    if column.above is not None:
        obeys &= numbers > column.above
    if column.least is not None:
        obeys &= numbers >= column.least
    if column.most is not None:
        obeys &= numbers <= column.most
    if column.nonzero:
        obeys &= numbers != 0
    return obeys


def _is_name(text: str, column: Column) -> bool:
    fits = len(text) <= column.longest and not invisible_in(text)
    return fits and not TYPOGRAPHIC.fullmatch(text)

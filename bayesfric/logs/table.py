"""The form in which every kind of log is read: named columns, each as long as its own table."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from bayesfric.arrays import Array
from bayesfric.errors import Fault, InputError, first_of, near
from bayesfric.recording.reading import LARGEST_FILE as LARGEST_FILE

MOST_CELLS = 64_000_000  # as doubles, 512 MiB
MOST_COLUMNS = 10_000
LISTED = 12  # most columns that an error lists
BLANK = {"", "nan", "na", "n/a", "#n/a", "null", "none", "<na>"}

Cells: TypeAlias = Sequence[str | None] | npt.NDArray[Any]


@dataclass(frozen=True)
class Log:
    """A log as in its file, before columns have a meaning.

    Parameters
    ----------
    name : str
        Name of the file.
    columns : mapping of str to Cells
        In the order of the file; those of one table have the same length. Texts as written, with
        None for a blank cell, or an array of numbers, shape (N,).
    first_row : int
        Number of the first row in an error.
    notes : tuple of str
        Notes on reading it, a sentence each.
    units : mapping of str to str
        Units of columns, if the file gives them.
    """

    name: str
    columns: Mapping[str, Cells]
    first_row: int = 1
    notes: tuple[str, ...] = ()
    units: Mapping[str, str] | None = None

    def name_of(self, column: str | int) -> str | None:
        """Return the name of a column from its name or its number from 1; None if unknown."""
        if isinstance(column, str):
            return column if column in self.columns else None
        names = list(self.columns)
        return names[column - 1] if 1 <= column <= len(names) else None

    def named(self, column: str | int) -> str:
        """Return the name of a column from its name or its number from 1.

        Raises
        ------
        InputError
            There is no such column.
        """
        name = self.name_of(column)
        if name is None:
            raise InputError([self.no_column(column)])
        return name

    def no_column(self, column: str | int) -> Fault:
        """Return the fault of a column that does not exist, with the existing columns."""
        names = list(self.columns)
        if isinstance(column, int):
            expected = f"a number of a column, from 1 to {len(names)}"
            return Fault(self.name, expected, column=str(column))
        listed = first_of(names, LISTED) or "its columns, but it has none"
        expected = f"one of {listed}{near(column, names)}"
        return Fault(self.name, expected, column=column)

    def parted(self, column: str | int, most: int, expected: str) -> dict[str, "Log"]:
        """Return the rows of each text of a column, in the order of the log.

        Columns that are not as long as this one are left out.

        Parameters
        ----------
        column : str or int
            Its name or number.
        most : int
            Largest number of different texts.
        expected : str
            What the texts are, for an error.

        Raises
        ------
        InputError
            There is no such column, it is blank, or it has more texts.
        """
        name = self.named(column)
        cells = texts_of(self.columns[name])
        rows: dict[str, list[int]] = {}
        for row, cell in enumerate(cells):
            if cell is not None and cell.strip():
                rows.setdefault(cell.strip(), []).append(row)
        if not 1 <= len(rows) <= most:
            raise InputError([Fault(self.name, expected, column=name, value=f"{len(rows):,}")])
        columns = {key: own for key, own in self.columns.items() if len(own) == len(cells)}
        return {
            text: replace(self, columns={key: _some(own, of) for key, own in columns.items()})
            for text, of in rows.items()
        }


def _some(cells: Cells, rows: list[int]) -> Cells:
    return cells[rows] if isinstance(cells, np.ndarray) else [cells[row] for row in rows]


@contextmanager
def damaged_is_told(path: Path, kind: str) -> Iterator[None]:
    """Turn any error of a library on a damaged file into one fault that names the file.

    Parameters
    ----------
    path : Path
        The file.
    kind : str
        What the file should be, such as ``a parquet file``.

    Raises
    ------
    InputError
        Any exception was raised inside.
    """
    try:
        yield
    except (InputError, TimeoutError):
        raise
    except Exception as error:  # libraries raise errors of every kind for damaged bytes
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        raise InputError([Fault(path.name, f"{kind} that can be read ({reason})")]) from error


def check_cells(name: str, cells: int, columns: int = 1) -> None:
    """Refuse a table that is too large.

    Raises
    ------
    InputError
        There are more than :data:`MOST_CELLS` cells, or :data:`MOST_COLUMNS` columns.
    """
    if cells > MOST_CELLS:
        expected = f"at most {MOST_CELLS:,} cells: cut the log"
        raise InputError([Fault(name, expected, value=f"{cells:,}")])
    if columns > MOST_COLUMNS:
        expected = f"at most {MOST_COLUMNS:,} columns"
        raise InputError([Fault(name, expected, value=f"{columns:,}")])


def leaves(record: Mapping[str, Any], deepest: int, before: str = "") -> dict[str, Any]:
    """Return the values of a record, with dotted names for those of records in it.

    Parameters
    ----------
    record : mapping of str
        The record.
    deepest : int
        Levels of records in it that are opened.
    before : str
        What stands before each name.
    """
    values: dict[str, Any] = {}
    for key, value in record.items():
        if isinstance(value, dict) and deepest:
            values |= leaves(value, deepest - 1, f"{before}{key}.")
        else:
            values[before + key] = value
    return values


def columns_of_array(name: str, array: npt.NDArray[Any]) -> tuple[dict[str, Cells], str | None]:
    """Return the columns of an array, and a note if its longer side was taken as time.

    Parameters
    ----------
    name : str
        Name of the array. Columns of a matrix are ``name[0]``, ``name[1]``, ….
    array : ndarray, shape (N,), (1, N), (N, k) or (k, N)
        Numbers or texts. Anything else has no columns.
    """
    if array.ndim not in (1, 2) or array.dtype.kind not in "fiubU" or not array.size:
        return {}, None
    if array.ndim == 1 or 1 in array.shape:
        return {name: array.ravel()}, None
    note = None
    if array.shape[0] < array.shape[1]:
        note = f"{name} is {array.shape[0]} × {array.shape[1]}: its longer side is taken as time."
        array = array.T
    check_cells(name, array.size, array.shape[1])
    return {f"{name}[{place}]": array[:, place] for place in range(array.shape[1])}, note


def log_of_arrays(
    name: str, arrays: Mapping[str, npt.NDArray[Any]], expected: str, *notes: str
) -> Log:
    """Return a log whose columns are those of arrays.

    Parameters
    ----------
    name : str
        Of the file.
    arrays : mapping of str to ndarray
        By name; one without columns is left out.
    expected : str
        What a file has from which a column comes.
    *notes : str
        What is to be told of the file beside which way arrays were taken.

    Raises
    ------
    InputError
        No array has a column, or there are too many cells.
    """
    columns: dict[str, Cells] = {}
    turned = []
    for key, array in arrays.items():
        parts, note = columns_of_array(key, array)
        columns |= parts
        turned += [] if note is None else [note]
    if not columns:
        raise InputError([Fault(name, expected)])
    check_cells(name, sum(map(len, columns.values())), len(columns))
    return Log(name, columns, 1, (*turned, *notes))


def texts_of(cells: Cells) -> list[str | None]:
    """Return cells as texts without loss of digits, None for a missing number."""
    if not isinstance(cells, np.ndarray):
        return list(cells)
    if cells.dtype.kind == "f":
        doubles = _in_doubles(cells).tolist()
        return [None if value != value else repr(value) for value in map(float, doubles)]
    return [str(value) for value in cells.tolist()]


def numbers_of(log: Log, column: str, faults: list[Fault]) -> Array:
    """Return a column's numbers, NaN for a blank cell, shape (N,).

    Parameters
    ----------
    log : Log
        The log.
    column : str
        Its name.
    faults : list of Fault
        Receives a fault for each cell that is no number.
    """
    cells = log.columns[column]
    if isinstance(cells, np.ndarray) and cells.dtype.kind in "fiub":
        numbers = _in_doubles(cells)
    else:
        numbers = np.array([number_of(cell) for cell in cells], dtype=np.float64)
    wrong = np.flatnonzero(np.isinf(numbers))
    if wrong.size:
        place, like = int(wrong[0]), int(wrong.size) - 1
        value = str(cells[place])
        faults.append(Fault(log.name, "a number", place + log.first_row, column, value, like))
    return numbers


def _in_doubles(cells: npt.NDArray[Any]) -> Array:
    """Return numbers as doubles; numbers of fewer bits become the short decimals that they encode.

    A stamp of 0.008 s in 32 bits becomes 0.008, as in a text, and not 0.00800000037997961. Six
    digits survive 32 bits; numbers with more digits are kept unchanged.
    """
    doubles = np.array(cells, dtype=np.float64)
    if cells.dtype.kind != "f" or cells.dtype.itemsize >= doubles.dtype.itemsize:
        return doubles
    digits = f"%.{np.finfo(cells.dtype).precision}g"
    decimals = np.array([float(digits % value) for value in doubles.tolist()])
    return np.where(decimals.astype(cells.dtype) == cells, decimals, doubles)


def number_of(cell: str | None) -> float:
    """Return the number of a cell, NaN for a blank cell and infinity for other text."""
    text = "" if cell is None else str(cell).strip()
    if text.lower() in BLANK:
        return float("nan")
    if "_" in text or not text.isascii():  # Python reads both
        return float("inf")
    try:
        return float(text)
    except ValueError:
        return float("inf")

"""What every kind of log is read to: named columns of cells, each as long as its own table."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from bayesfric.arrays import Array, Whole
from bayesfric.errors import Fault, InputError, near

LARGEST_FILE = 512 * 1024**2  # bytes, of a file and of what is unpacked from it
MOST_CELLS = 64_000_000  # as doubles, 512 MiB
MOST_COLUMNS = 10_000
LISTED = 12  # columns in an error
BLANK = {"", "nan", "na", "n/a", "#n/a", "null", "none", "<na>"}

Cells: TypeAlias = Sequence[str | None] | npt.NDArray[Any]


@dataclass(frozen=True)
class Log:
    """A log as its file has it, before anybody says what a column is.

    Parameters
    ----------
    name : str
        Of the file.
    columns : mapping of str to Cells
        In the order of the file; those of one table have one length. Texts as written, None where
        a cell is blank, or an array of numbers, shape (N,).
    first_row : int
        What an error calls the first row.
    notes : tuple of str
        Sentences: what was done while it was read.
    units : mapping of str to str
        Of columns whose unit the file says.
    """

    name: str
    columns: Mapping[str, Cells]
    first_row: int = 1
    notes: tuple[str, ...] = ()
    units: Mapping[str, str] | None = None

    def name_of(self, column: str | int) -> str | None:
        """Return the name of a column by its name or its number from 1; None where it has none."""
        if isinstance(column, str):
            return column if column in self.columns else None
        names = list(self.columns)
        return names[column - 1] if 1 <= column <= len(names) else None

    def no_column(self, column: str | int) -> Fault:
        """Return that there is no such column, with those that there are."""
        names = list(self.columns)
        if isinstance(column, int):
            expected = f"a number of a column, from 1 to {len(names)}"
            return Fault(self.name, expected, column=str(column))
        listed = ", ".join(names[:LISTED]) + (", …" if len(names) > LISTED else "")
        expected = f"one of {listed or 'its columns, but it has none'}{near(column, names)}"
        return Fault(self.name, expected, column=column)

    def taken(self, rows: Whole, length: int) -> "Log":
        """Return these rows of the columns that have this length, without the others."""
        columns = {
            name: cells[rows] if isinstance(cells, np.ndarray) else [cells[row] for row in rows]
            for name, cells in self.columns.items()
            if len(cells) == length
        }
        return Log(self.name, columns, self.first_row, self.notes, self.units)


@contextmanager
def damaged_is_told(path: Path, kind: str) -> Iterator[None]:
    """Turn whatever a library makes of a damaged file into one fault that names the file.

    Parameters
    ----------
    path : Path
        The file.
    kind : str
        What it should be, as ``a parquet file``.

    Raises
    ------
    InputError
        Something was raised inside.
    """
    try:
        yield
    except (InputError, TimeoutError):
        raise
    except Exception as error:  # libraries raise errors of every kind for damaged bytes
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        raise InputError([Fault(path.name, f"{kind} that can be read ({reason})")]) from error


def check_cells(name: str, cells: int, columns: int = 1) -> None:
    """Refuse a table that is larger than what is read.

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


def columns_of_array(name: str, array: npt.NDArray[Any]) -> tuple[dict[str, Cells], str | None]:
    """Return the columns of an array, and a note where its longer side was taken as time.

    Parameters
    ----------
    name : str
        Of the array. Columns of a matrix are ``name[0]``, ``name[1]``, ….
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
    """Return cells as texts that lose nothing, None where there is no number."""
    if not isinstance(cells, np.ndarray):
        return list(cells)
    if cells.dtype.kind == "f":
        doubles = _in_doubles(cells).tolist()
        return [None if value != value else repr(value) for value in map(float, doubles)]
    return [str(value) for value in cells.tolist()]


def numbers_of(log: Log, column: str, faults: list[Fault]) -> Array:
    """Return a column's numbers, NaN where a cell is blank, shape (N,).

    Parameters
    ----------
    log : Log
        Has the column.
    column : str
        Its name.
    faults : list of Fault
        Gets what is no number.
    """
    cells = log.columns[column]
    if isinstance(cells, np.ndarray) and cells.dtype.kind in "fiub":
        numbers = _in_doubles(cells)
        wrong = np.flatnonzero(np.isinf(numbers))
    else:
        numbers = np.array([_number(cell) for cell in cells], dtype=np.float64)
        wrong = np.flatnonzero(np.isinf(numbers))
    if wrong.size:
        place, like = int(wrong[0]), int(wrong.size) - 1
        value = str(cells[place])
        faults.append(Fault(log.name, "a number", place + log.first_row, column, value, like))
    return numbers


def _in_doubles(cells: npt.NDArray[Any]) -> Array:
    """Return numbers as doubles; those of fewer bits are the short decimals that they stand for.

    A stamp of 0.008 s in 32 bits is 0.008, as it is in a text, and not 0.00800000037997961: six
    digits come through 32 bits as they were. What has more digits is let be.
    """
    doubles = np.array(cells, dtype=np.float64)
    if cells.dtype.kind != "f" or cells.dtype.itemsize >= doubles.dtype.itemsize:
        return doubles
    digits = f"%.{np.finfo(cells.dtype).precision}g"
    decimals = np.array([float(digits % value) for value in doubles.tolist()])
    return np.where(decimals.astype(cells.dtype) == cells, decimals, doubles)


def _number(cell: str | None) -> float:
    """Return the number of a cell, NaN where it is blank and infinity where it is none."""
    text = "" if cell is None else str(cell).strip()
    if text.lower() in BLANK:
        return float("nan")
    if "_" in text or not text.isascii():  # Python reads both
        return float("inf")
    try:
        return float(text)
    except ValueError:
        return float("inf")

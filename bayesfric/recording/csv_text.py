"""Bytes of a CSV file → its cells as text, each with its line in the file."""

import csv
import io
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pandas as pd

from bayesfric.errors import Fault, InputError

__all__ = ["TextTable", "decode_utf8", "parse_csv"]


@dataclass(frozen=True)
class TextTable:
    """A CSV file as it was written.

    Parameters
    ----------
    file : str
        Path relative to the recording.
    cells : DataFrame
        Stripped text, one column for each named column of the header.
    lines : ndarray of int64, shape (len(cells),)
        Line of the file on which each row starts; the header is line 1.
    unnamed : int
        Columns whose header is empty; they are kept out.
    ragged : frozenset of int
        Positions of the rows of the wrong length.
    faults : tuple of Fault
        Rows of the wrong length and repeated column names.
    """

    file: str
    cells: pd.DataFrame
    lines: npt.NDArray[np.int64]
    unnamed: int
    ragged: frozenset[int]
    faults: tuple[Fault, ...]

    def faults_at(self, positions: list[int], column: str, expected: str) -> list[Fault]:
        """List one fault, at `column`, for each of these rows."""
        lines = self.lines[positions].tolist()
        values = self.cells[column].iloc[positions]
        return [
            Fault(self.file, expected, line, column, value)
            for line, value in zip(lines, values, strict=True)
        ]


def decode_utf8(file: str, data: bytes) -> str:
    """Text of a file, without a byte order mark.

    Raises
    ------
    InputError
        If the bytes are not UTF-8, or hold a NUL.
    """
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        row = error.object.count(b"\n", 0, error.start) + 1
        found = error.object[error.start : error.start + 1].hex()
        raise InputError([Fault(file, "UTF-8 text", row=row, value=f"byte 0x{found}")]) from None
    nul = text.find("\0")
    if nul >= 0:
        row = text.count("\n", 0, nul) + 1
        raise InputError([Fault(file, "text without NUL bytes", row=row, value="byte 0x00")])
    return text


def parse_csv(file: str, data: bytes) -> TextTable:
    """Split a CSV file into cells.

    Blank lines, and rows whose cells are all empty, are passed over. A row of the
    wrong length is a fault; it is cut or filled up so that the rest can be checked.

    Raises
    ------
    InputError
        If there is no table to speak of: not UTF-8, empty, header only, bad quotes.
    """
    rows, lines = _split(file, decode_utf8(file, data))
    if not rows or lines[0] != 1:
        raise InputError([Fault(file, "a header in line 1 and at least one row")])
    header = [name.strip() for name in rows[0]]
    if len(rows) == 1:
        raise InputError([Fault(file, "at least one row below the header", row=1)])
    del rows[0], lines[0]

    faults = [
        Fault(file, "a column name once only", row=1, column=name, value=name)
        for name in dict.fromkeys(header)
        if name and header.count(name) > 1
    ]
    width, ragged = len(header), set()
    for position, row in enumerate(rows):
        if len(row) != width:
            expected = f"{width} cells, as in the header"
            faults.append(Fault(file, expected, row=lines[position], value=f"{len(row)} cells"))
            ragged.add(position)
            rows[position] = (row + [""] * width)[:width]

    columns = zip(header, zip(*rows, strict=True), strict=True)
    cells = {name: [cell.strip() for cell in column] for name, column in columns if name}
    return TextTable(
        file,
        pd.DataFrame(cells, dtype=object),
        np.array(lines, dtype=np.int64),
        unnamed=header.count(""),
        ragged=frozenset(ragged),
        faults=tuple(faults),
    )


def _split(file: str, text: str) -> tuple[list[list[str]], list[int]]:
    """Rows that hold anything, and the line on which each starts."""
    reader = csv.reader(io.StringIO(text, newline=""), strict=True)
    rows: list[list[str]] = []
    lines: list[int] = []
    start = 1
    try:
        for row in reader:
            if any(map(str.strip, row)):
                rows.append(row)
                lines.append(start)
            start = reader.line_num + 1
    except csv.Error as error:
        expected = f'comma-separated cells, quoted with pairs of " ({error})'
        raise InputError([Fault(file, expected, row=start)]) from None
    return rows, lines

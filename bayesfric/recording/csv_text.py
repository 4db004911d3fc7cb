"""Bytes of a CSV file → its cells as text, each with its line in the file."""

import codecs
import csv
import io
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TypeAlias

import numpy as np
import numpy.typing as npt
import pandas as pd

from bayesfric.arrays import Flags
from bayesfric.errors import Fault, InputError

Cells: TypeAlias = Sequence[str] | npt.NDArray[np.object_]
"""A column as text."""
Ragged: TypeAlias = dict[int, list[str]]
"""Rows with a length other than the header's, as written, by position."""

LISTED = 20  # most faults of one kind that are listed one by one
MOST_COLUMNS = 1000
LONGEST = 100_000  # longest line that is read in columns; csv refuses a longer cell
BLANKS = " \t\v\f\x1c\x1d\x1e\x1f"  # ASCII blanks, without line ends
COMMENT = "rows of the table alone (a line that begins with # is no comment here: take it out)"
COMMAS = " (are there commas in numbers? the decimal mark is a point)"
TRAILING = " (is there a comma too much at the end?)"
UTF16 = "this is UTF-16: is it a spreadsheet's “Unicode text”?"
SPREADSHEET = "this is a spreadsheet: save its sheet as CSV"
NOT_UTF8 = {
    codecs.BOM_UTF16_LE: UTF16,
    codecs.BOM_UTF16_BE: UTF16,
    b"PK\3\4": SPREADSHEET,
    b"\xd0\xcf\x11\xe0": SPREADSHEET,
    b"": "is it saved in another encoding, such as Windows-1252?",
}


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
        Number of columns with an empty header; they are ignored.
    ragged : frozenset of int
        Positions of rows of the wrong length and of comments, whose fault is already reported.
    faults : tuple of Fault
        Rows of the wrong length and repeated column names.
    written : mapping of str to str
        Names of columns in the file that differ from the format's, by the format's name.
    """

    file: str
    cells: pd.DataFrame
    lines: npt.NDArray[np.int64]
    unnamed: int
    ragged: frozenset[int]
    faults: tuple[Fault, ...]
    written: Mapping[str, str] = field(default_factory=dict)

    @cached_property
    def is_ragged(self) -> Flags:
        """Whether each row is one of `ragged`, shape (len(cells),)."""
        flags = np.zeros(len(self.cells), dtype=np.bool_)
        flags[list(self.ragged)] = True
        return flags

    def faults_at(
        self,
        positions: Sequence[int] | npt.NDArray[np.intp],
        column: str,
        expected: str,
        most: int = LISTED,
    ) -> list[Fault]:
        """List a fault, at `column`, for each of these rows; the last one counts the rest.

        Rows of the wrong length get no further fault.
        """
        if self.ragged:
            positions = [position for position in positions if position not in self.ragged]
        shown = [int(position) for position in positions[:most]]
        lines = self.lines[shown].tolist()
        values = self.cells[column].iloc[shown]
        faults = [
            Fault(self.file, expected, line, self.written.get(column, column), value)
            for line, value in zip(lines, values, strict=True)
        ]
        return with_rest(faults, len(positions) - len(shown))


def with_rest(faults: list[Fault], rest: int) -> list[Fault]:
    """Return the faults; the last one counts `rest` further faults of its kind."""
    return [*faults[:-1], replace(faults[-1], like=rest)] if faults and rest else faults


def with_more(faults: list[Fault], more: int) -> list[Fault]:
    """Return the faults; the last one counts `more` in addition to those it counts already."""
    return with_rest(faults, faults[-1].like + more) if faults and more else faults


def decode_utf8(file: str, data: bytes) -> str:
    """Text of a file, without a byte order mark.

    Raises
    ------
    InputError
        If the bytes are not UTF-8, or contain a NUL.
    """
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        row = error.object.count(b"\n", 0, error.start) + 1
        byte = error.object[error.start : error.start + 1].hex()
        expected = "UTF-8 text" + next(
            (f" ({hint})" for begin, hint in NOT_UTF8.items() if data.startswith(begin)), ""
        )
        raise InputError([Fault(file, expected, row=row, value=f"byte 0x{byte}")]) from None
    nul = text.find("\0")
    if nul >= 0:
        row = text.count("\n", 0, nul) + 1
        raise InputError([Fault(file, "text without NUL bytes", row=row, value="byte 0x00")])
    return text


def parse_csv(file: str, data: bytes) -> TextTable:
    """Split a CSV file into cells.

    Blank lines, and rows whose cells are all empty, are skipped. A row of the wrong
    length is a fault. It is cut or padded so that the other cells can be checked.

    Raises
    ------
    InputError
        If the file is no table: not UTF-8, empty, header only, bad quotes, cells that are not
        separated by commas, no row of the header's length.
    """
    text = decode_utf8(file, data)
    header, columns, lines, ragged = _in_columns(file, data, text) or _split(file, text)
    named = Counter(name for name in header if name)
    faults = [
        Fault(file, "a column name once only", row=1, column=name, value=name)
        for name, count in named.items()
        if count > 1
    ]
    if ragged:
        _blank_comments(columns, ragged)
        faults += _ragged_faults(file, len(header), ragged, lines)
    cells = {name: column for name, column in zip(header, columns, strict=True) if name}
    return TextTable(
        file,
        pd.DataFrame(cells, dtype=object),
        np.array(lines, dtype=np.int64),
        unnamed=header.count(""),
        ragged=frozenset(ragged),
        faults=tuple(faults),
    )


def _is_comment(row: Sequence[str]) -> bool:
    return row[0].startswith("#")


def _blank_comments(columns: Sequence[Cells], ragged: Ragged) -> None:
    """Empty the cells of comment lines, so that none is read as an id."""
    for position in (place for place, row in ragged.items() if _is_comment(row)):
        for column in columns:
            column[position] = ""  # type: ignore[index]


def _ragged_faults(file: str, width: int, ragged: Ragged, lines: Sequence[int]) -> list[Fault]:
    """Return one fault for all comments, one for all rows that are too long, and the others.

    Raises
    ------
    InputError
        No row has the header's length.
    """
    comments = {place: row for place, row in ragged.items() if _is_comment(row)}
    others = {place: row for place, row in ragged.items() if place not in comments}
    faults = []
    if comments:
        first = min(comments)
        shown = ",".join(comments[first]).rstrip(",")
        faults += with_rest([Fault(file, COMMENT, lines[first], None, shown)], len(comments) - 1)
    if not others:
        return faults
    hint = _too_many(width, others)
    together = bool(hint) or len(ragged) == len(lines)
    in_each = ", in each row" if len(ragged) == len(lines) else ""
    expected = f"{width} cells, as in the header{in_each}{hint}"
    faults += with_rest(
        [
            Fault(file, expected, lines[place], None, f"{len(others[place])} cells")
            for place in list(others)[: 1 if together else LISTED]
        ],
        len(others) - (1 if together else min(len(others), LISTED)),
    )
    if len(ragged) == len(lines):
        raise InputError(faults)
    return faults


def _too_many(width: int, ragged: Ragged) -> str:
    """Return the possible cause why each of these rows is too long, in brackets."""
    if min(map(len, ragged.values())) <= width:
        return ""
    return COMMAS if any(any(row[width:]) for row in ragged.values()) else TRAILING


def _check_header(file: str, header: list[str]) -> None:
    """Refuse a header whose cells are not separated by commas, or that is too long."""
    for mark, name in ((";", "semicolons"), ("\t", "tabs")):
        if len(header) == 1 and mark in header[0]:
            expected = f"commas between cells, not {name}; and a point as the decimal mark"
            raise InputError([Fault(file, expected, row=1, value=header[0])])
    if header[0].startswith("#") and (len(header) == 1 or header[0][1:2] in ("", " ")):
        expected = "a header, not a comment: each line is read"
        raise InputError([Fault(file, expected, row=1, value=header[0])])
    if header[0].lower().startswith("sep="):
        expected = "a header, not a spreadsheet's note of its separator: take the line out"
        raise InputError([Fault(file, expected, row=1, value=",".join(header))])
    if len(header) > MOST_COLUMNS:
        expected = f"at most {MOST_COLUMNS:,} columns"
        raise InputError([Fault(file, expected, row=1, value=f"{len(header):,} columns")])


def _in_columns(
    file: str, data: bytes, text: str
) -> tuple[list[str], list[Cells], Sequence[int], Ragged] | None:
    """Return the result of :func:`_split` many times faster for a plain table; else None.

    A table is plain if it has no quotation marks, each line has as many commas as the header,
    lines end with a line feed only, and no first cell is empty or equal to that of the header. All
    other tables are left to :func:`_split`, which reports their faults.
    """
    header = [cell.strip() for cell in text[: text.find("\n")].split(",")]
    rows = text.count("\n") - text.endswith("\n")
    if (
        rows < 1
        or len(header) < 2
        or not any(header)
        or '"' in text
        or ("\r" in text and text.count("\r") != text.count("\r\n"))
        or text.count(",") != (rows + 1) * (len(header) - 1)
        or _has_long_line(text)
        or ("#" in text and re.search(r"\n\s*#", text) is not None)
    ):
        return None
    _check_header(file, header)
    try:
        # The total of commas is right, and no line has more than it should: so none has fewer.
        table = pd.read_csv(
            io.BytesIO(data),
            header=None,
            dtype=object,
            na_filter=False,
            quoting=csv.QUOTE_NONE,
        )
    except pd.errors.ParserError:
        return None
    columns: list[Cells] = [table[name].to_numpy()[1:] for name in table]
    if not text.isascii() or any(blank in text for blank in BLANKS):
        columns = [np.array([cell.strip() for cell in cells], dtype=object) for cells in columns]
    if np.any(columns[0] == "") or np.any(columns[0] == header[0]):
        return None
    return header, columns, range(2, rows + 2), {}


def _has_long_line(text: str) -> bool:
    start = 0
    while len(text) - start > LONGEST:
        end = text.rfind("\n", start, start + LONGEST)
        if end < 0:
            return True
        start = end + 1
    return False


def _split(file: str, text: str) -> tuple[list[str], list[Cells], Sequence[int], Ragged]:
    """Return header, columns, the line on which each row starts, and rows of another length.

    Empty rows are skipped. Equal cells share one string, since ids and displacements
    repeat, and a table may have a million rows.
    """
    reader = csv.reader(io.StringIO(text, newline=""), strict=True)
    header: list[str] | None = None
    columns: list[list[str]] = []
    lines: list[int] = []
    ragged: Ragged = {}
    once: dict[str, str] = {}
    start = 1
    try:
        for row in reader:
            stripped = [cell.strip() for cell in row]
            if any(stripped):
                if header is None:
                    if start != 1:
                        break
                    _check_header(file, stripped)
                    header = stripped
                    columns = [[] for _ in header]
                else:
                    if stripped == header:
                        expected = "rows below one header (are two files joined? take it out)"
                        raise InputError([Fault(file, expected, row=start, value=",".join(header))])
                    alone = _is_comment(stripped) and not any(stripped[1:]) and len(header) > 1
                    if alone or len(stripped) != len(header):
                        ragged[len(lines)] = stripped.copy()
                        stripped += [""] * (len(header) - len(stripped))
                    lines.append(start)
                    for column, cell in zip(columns, stripped, strict=False):
                        column.append(once.setdefault(cell, cell))
            start = reader.line_num + 1
    except csv.Error as error:
        expected = f'comma-separated cells, quoted with pairs of " ({error})'
        raise InputError([Fault(file, expected, row=start)]) from None
    if header is None:
        raise InputError([Fault(file, "a header in line 1 and at least one row")])
    if not lines:
        raise InputError([Fault(file, "at least one row below the header", row=1)])
    return header, [*columns], lines, ragged

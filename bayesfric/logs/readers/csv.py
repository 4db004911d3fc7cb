"""CSV: with or without header, after lines of preamble and before rows of units, any separator."""

import csv
import re
from collections.abc import Collection, Iterator
from math import isinf
from pathlib import Path

from bayesfric.errors import Fault, InputError
from bayesfric.files import file_bytes
from bayesfric.logs.mapping import CsvForm
from bayesfric.logs.table import (
    BLANK,
    LARGEST_FILE,
    MOST_CELLS,
    Log,
    check_cells,
    damaged_is_told,
    number_of,
)

SEPARATORS = {"tab": "\t", "comma": ",", "semicolon": ";", "space": " "}
OTHERS = (";", "\t", "|", ",")
DECIMAL_COMMA = re.compile(r"[\d:TtZ /+-]*,\d+([eE][+-]?\d+)?Z?", re.ASCII)
WITH_COMMA = re.compile(r"[+-]?\d+,\d+", re.ASCII)
LONGEST_CELL = 131_072  # characters


def read(path: Path, form: CsvForm, wanted: Collection[str | int] | None = None) -> Log:
    """Return the columns of a CSV as texts.

    Parameters
    ----------
    path : Path
        UTF-8, with or without a byte-order mark.
    form : CsvForm
        How it is written.
    wanted : collection of str or int, or None
        Columns by name or number from 1; the others are there and empty.

    Raises
    ------
    InputError
        It is no text, a row has more cells than the header, or the form cannot be meant.
    """
    lines = lines_of(decoded(path))
    with damaged_is_told(path, "a CSV file"):
        body = lines[form.preamble :]
        names = _names(path.name, next(split(body[:1], form.separator), []), form)
        rows = split(body[int(form.header) :], form.separator)
        units = {}
        for _ in range(form.unit_rows):
            units = dict(zip(names, next(rows, []), strict=False))
        first = form.preamble + int(form.header) + form.unit_rows + 1
        taken = [
            place
            for place, name in enumerate(names)
            if wanted is None or name in wanted or place + 1 in wanted
        ]
        columns = _columns(path.name, rows, first, names, taken, form.decimal)
        if not columns or (taken and not columns[names[taken[0]]]):
            raise InputError([Fault(path.name, "rows below the header")])
        _check_rows(path.name, columns, [names[place] for place in taken], first)
    return Log(path.name, columns, first, (), units or None)


def decoded(path: Path) -> str:
    """Return the text of a file.

    Raises
    ------
    InputError
        It cannot be read, or is not UTF-8.
    """
    data = file_bytes(path, path.name, LARGEST_FILE)
    try:
        return data.decode("utf-16" if data[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig")
    except UnicodeDecodeError as error:
        row = data.count(b"\n", 0, error.start) + 1
        raise InputError([Fault(path.name, "a text in UTF-8", row=row)]) from error


def lines_of(text: str) -> list[str]:
    """Return the lines of a text, of which a form feed in a name ends none."""
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    return lines[:-1] if lines[-1] == "" else lines


def split(lines: list[str], separator: str) -> Iterator[list[str]]:
    """Return the cells of each line; ``space`` stands for any run of blanks."""
    if separator == "space":
        return (line.split() for line in lines)
    csv.field_size_limit(LONGEST_CELL)
    return csv.reader(lines, delimiter=SEPARATORS.get(separator, separator), strict=False)


def _names(file: str, head: list[str], form: CsvForm) -> list[str]:
    """Return the names of columns: those of the header, or their numbers."""
    if not form.header:
        return [str(place + 1) for place in range(len(head))]
    names = [cell.strip() for cell in head]
    if not any(names):
        expected = "a header with the names of the columns"
        raise InputError([Fault(file, expected, row=form.preamble + 1)])
    _check_header(file, names, form)
    return _apart(names)


def _check_header(file: str, names: list[str], form: CsvForm) -> None:
    row = form.preamble + 1
    if not any(isinf(number_of(name)) for name in names):
        expected = "names of columns; is header = false of [csv] meant?"
        raise InputError([Fault(file, expected, row, value=",".join(names))])
    if len(names) == 1:
        other = next((sign for sign in OTHERS if sign in names[0]), None)
        if other is not None:
            said = "tab" if other == "\t" else other
            expected = f'several columns; is separator = "{said}" of [csv] meant?'
            raise InputError([Fault(file, expected, row, value=names[0])])


def _apart(names: list[str]) -> list[str]:
    """Return names of which no two are the same: ``q``, ``q.1``."""
    used: dict[str, int] = {}
    apart = []
    for place, name in enumerate(names):
        name = name or f"column {place + 1}"
        used[name] = used.get(name, -1) + 1
        apart.append(f"{name}.{used[name]}" if used[name] else name)
    return apart


def _columns(
    file: str,
    rows: Iterator[list[str]],
    first: int,
    names: list[str],
    taken: list[int],
    decimal: str,
) -> dict[str, list[str | None]]:
    check_cells(file, 0, len(names))
    most = MOST_CELLS // max(len(taken), 1)
    kept: list[list[str | None]] = [[] for _ in taken]
    blank_since: int | None = None
    for count, cells in enumerate(rows, start=1):
        if len(cells) > len(names) and any(cell.strip() for cell in cells[len(names) :]):
            expected = f"{len(names)} cells, as its first line has"
            raise InputError([Fault(file, expected, first + count - 1, value=f"{len(cells)}")])
        blank_since = (count if blank_since is None else blank_since) if not cells else None
        if count > most:
            check_cells(file, MOST_CELLS + 1)
        for column, place in zip(kept, taken, strict=True):
            column.append(_cell(cells[place], decimal) if place < len(cells) else None)
    if blank_since is not None:  # blank lines at the end are no rows
        kept = [column[: blank_since - 1] for column in kept]
    columns: dict[str, list[str | None]] = {name: [] for name in names}
    return columns | {names[place]: column for place, column in zip(taken, kept, strict=True)}


def _check_rows(
    file: str, columns: dict[str, list[str | None]], names: list[str], first: int
) -> None:
    """Refuse rows of units and decimal commas of which the mapping does not say that they are."""
    rows = list(zip(*(columns[name][:2] for name in names), strict=True))
    if len(rows) == 2 and not any(map(_has_digit, rows[0])) and all(map(_has_digit, rows[1])):
        value = ",".join(str(cell) for cell in rows[0] if cell is not None)
        expected = "numbers; is unit_rows = 1 of [csv] meant?"
        if value:
            raise InputError([Fault(file, expected, first, value=value)])
    comma = next((cell for cell in rows[0] if cell and WITH_COMMA.fullmatch(cell)), None)
    if comma is not None:
        expected = 'a number; is decimal = "," of [csv] meant?'
        raise InputError([Fault(file, expected, first, value=comma)])


def _has_digit(cell: str | None) -> bool:
    return cell is not None and any(sign.isdigit() for sign in cell)


def _cell(text: str, decimal: str) -> str | None:
    text = text.strip()
    if text.lower() in BLANK:
        return None
    return text.replace(decimal, ".") if decimal != "." and DECIMAL_COMMA.fullmatch(text) else text

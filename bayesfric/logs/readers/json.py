"""JSON: a list of records, a record of lists, or a record a line; nested names are dotted."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from bayesfric.errors import Fault, InputError
from bayesfric.logs.readers.csv import decoded, lines_of
from bayesfric.logs.table import Cells, Log, check_cells, columns_of_array, damaged_is_told, leaves

DEEPEST = 8  # levels of records in a record
FORMS = "a list of records, a record of lists of one length, or a record a line"


def read(path: Path) -> Log:
    """Return the columns of a JSON file, or of one with a record a line.

    Numbers are kept as they are written, so that stamps in nanoseconds lose nothing.

    Raises
    ------
    InputError
        It does not parse, or is none of the three forms.
    """
    text = decoded(path)
    with damaged_is_told(path, "JSON"):
        try:
            whole = _parsed(text)
        except ValueError:
            if text.count("\n") == 0:
                raise
            return _of_records(path.name, _lines(path.name, text))
        if isinstance(whole, dict):
            return _of_lists(path.name, whole)
        if isinstance(whole, list):
            return _of_records(path.name, whole)
    raise InputError([Fault(path.name, FORMS)])


def _parsed(text: str) -> Any:
    # Numbers stay texts: a float would round a stamp, and "1e999" is no infinity.
    return json.loads(text, parse_int=_Number, parse_float=_Number, parse_constant=_constant)


class _Number(str):
    """A number as it is written."""

    __slots__ = ()


def _constant(text: str) -> str | None:
    return None if text == "NaN" else text


def _lines(name: str, text: str) -> list[Any]:
    records = []
    for row, line in enumerate(lines_of(text), start=1):
        if line.strip():
            try:
                records.append(_parsed(line))
            except ValueError as error:
                raise InputError([Fault(name, f"JSON that parses ({error})", row=row)]) from error
    return records


def _of_records(name: str, records: list[Any]) -> Log:
    if not records or not all(isinstance(record, dict) for record in records):
        raise InputError([Fault(name, FORMS)])
    columns: dict[str, list[str | None]] = {}
    for row, record in enumerate(records):
        for column, cell in _flat(record).items():
            cells = columns.setdefault(column, [])
            cells += [None] * (row - len(cells))
            cells.append(cell)
        check_cells(name, row * len(columns), len(columns))
    for cells in columns.values():
        cells += [None] * (len(records) - len(cells))
    return Log(name, columns)


def _of_lists(name: str, whole: dict[str, Any]) -> Log:
    columns: dict[str, Cells] = {}
    notes = []
    for key, value in leaves(whole, DEEPEST).items():
        if not isinstance(value, list) or not value:
            continue
        if all(isinstance(cell, list) for cell in value):
            parts, note = _of_matrix(key, value)
            columns |= parts
            notes += [] if note is None else [note]
        elif all(isinstance(cell, dict) for cell in value):
            inner = _of_records(name, value).columns
            columns |= {f"{key}.{column}": cells for column, cells in inner.items()}
        else:
            columns[key] = [_text(cell) for cell in value]
    if not columns:
        raise InputError([Fault(name, FORMS)])
    check_cells(name, sum(map(len, columns.values())), len(columns))
    return Log(name, columns, 1, tuple(notes))


def _of_matrix(key: str, rows: list[list[Any]]) -> tuple[dict[str, Cells], str | None]:
    widths = {len(row) for row in rows}
    if len(widths) != 1:
        return {}, None
    texts = np.array([["" if (cell := _text(c)) is None else cell for c in row] for row in rows])
    parts, note = columns_of_array(key, texts)
    return {name: list(map(str, cells)) for name, cells in parts.items()}, note


def _flat(record: dict[str, Any]) -> dict[str, str | None]:
    """Return the cells of a record: those of a list get its name and their place from 0."""
    cells: dict[str, str | None] = {}
    for key, value in leaves(record, DEEPEST).items():
        if isinstance(value, list):
            cells |= {f"{key}[{place}]": _text(cell) for place, cell in enumerate(value)}
        else:
            cells[key] = _text(value)
    return cells


def _text(value: Any) -> str | None:
    return None if value is None else str(value)

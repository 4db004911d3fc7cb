"""Parquet, as LeRobot keeps its episodes: numbers, and lists with a number a joint."""

import json
from collections.abc import Collection
from pathlib import Path
from typing import Any

import numpy as np

from bayesfric.errors import Fault, InputError, needs_extra
from bayesfric.files import file_bytes
from bayesfric.logs.table import LARGEST_FILE, Cells, Log, check_cells, damaged_is_told

ABOVE = 4  # folders above the file in which LeRobot's description is looked for
DESCRIPTION = Path("meta") / "info.json"
LARGEST_DESCRIPTION = 4 * 1024**2  # bytes


def read(path: Path, wanted: Collection[str | int] | None = None) -> Log:
    """Return the columns of a parquet file.

    A list of a number a joint has columns ``name[0]``, ``name[1]``, …, or, where a
    ``meta/info.json`` above the file has their names, ``name[elbow]``, ….

    Raises
    ------
    InputError
        pyarrow is not installed; the file is damaged or too large.
    """
    with needs_extra("logs", "an installation that reads parquet", path.name):
        import pyarrow as pa
        import pyarrow.parquet as pq
    columns: dict[str, Cells] = {}
    described = _described(path)
    with damaged_is_told(path, "a parquet file"), pq.ParquetFile(path) as file:
        fields = [field for field in file.schema_arrow if _is_read(pa, field.type)]
        _check_sizes(path.name, file.metadata, len(fields))
        for field in fields:
            if wanted is not None and not _wanted(field.name, wanted):
                continue
            array = file.read([field.name]).column(0).combine_chunks()
            if isinstance(array, pa.ChunkedArray):
                array = pa.concat_arrays(array.chunks)
            columns |= _columns(pa, path.name, field.name, array, described.get(field.name, ()))
            check_cells(path.name, sum(map(len, columns.values())), len(columns))
    if not columns:
        names = ", ".join(field.name for field in fields)
        raise InputError([Fault(path.name, f"columns of numbers (it has: {names or 'none'})")])
    return Log(path.name, columns)


def _wanted(name: str, wanted: Collection[str | int]) -> bool:
    numbered = any(isinstance(column, int) for column in wanted)
    return numbered or any(name in (column, str(column).partition("[")[0]) for column in wanted)


def _is_list(pa: Any, kind: Any) -> bool:
    return bool(
        pa.types.is_list(kind) or pa.types.is_large_list(kind) or pa.types.is_fixed_size_list(kind)
    )


def _is_number(pa: Any, kind: Any) -> bool:
    return bool(pa.types.is_integer(kind) or pa.types.is_floating(kind))


def _is_read(pa: Any, kind: Any) -> bool:
    if _is_list(pa, kind):
        return _is_number(pa, kind.value_type)
    text = pa.types.is_string(kind) or pa.types.is_large_string(kind)
    return _is_number(pa, kind) or pa.types.is_timestamp(kind) or bool(text)


def _check_sizes(name: str, metadata: Any, fields: int) -> None:
    """Refuse a file that is too large when it is unpacked, by what its row groups say."""
    size = cells = 0
    for group in range(metadata.num_row_groups):
        row_group = metadata.row_group(group)
        size += row_group.total_byte_size
        cells += sum(row_group.column(place).num_values for place in range(row_group.num_columns))
    check_cells(name, max(cells, metadata.num_rows), fields)
    if not 0 <= size <= LARGEST_FILE:
        expected = f"at most {LARGEST_FILE:,} bytes when it is unpacked: cut the log"
        raise InputError([Fault(name, expected, value=f"{size:,} bytes")])


def _columns(
    pa: Any, file: str, name: str, array: Any, described: tuple[str, ...]
) -> dict[str, Cells]:
    if pa.types.is_timestamp(array.type):  # as ISO 8601, by nanoseconds since 1970
        whole = array.cast(pa.timestamp("ns")).to_numpy(zero_copy_only=False)
        return {name: [None if np.isnat(stamp) else f"{stamp}"[:29] for stamp in whole]}
    if not _is_list(pa, array.type):
        if _is_number(pa, array.type):
            return {name: array.to_numpy(zero_copy_only=False)}
        return {name: array.to_pylist()}
    lengths = set(array.value_lengths().to_pylist()) - {None}
    if len(lengths) != 1 or array.null_count:
        raise InputError([Fault(file, "lists of one length in all rows", column=name)])
    (width,) = lengths
    check_cells(file, len(array) * width, width)
    matrix = array.flatten().to_numpy(zero_copy_only=False).reshape(len(array), width)
    keys = described if len(described) == width else tuple(map(str, range(width)))
    return {f"{name}[{key}]": matrix[:, place] for place, key in enumerate(keys)}


def _described(path: Path) -> dict[str, tuple[str, ...]]:
    """Return the names of the numbers in each list, of LeRobot's ``meta/info.json``."""
    for folder in list(path.resolve().parents)[:ABOVE]:
        file = folder / DESCRIPTION
        if not file.is_file():
            continue
        with damaged_is_told(file, "LeRobot's description of the data"):
            description = json.loads(file_bytes(file, file.name, LARGEST_DESCRIPTION))
            features = description.get("features", {})
            return {key: _joint_names(feature.get("names")) for key, feature in features.items()}
    return {}


def _joint_names(names: Any) -> tuple[str, ...]:
    """Return names without what LeRobot puts behind those of motors, ``elbow.pos``."""
    if isinstance(names, dict):
        names = next(iter(names.values()), None)
    if not isinstance(names, list):
        return ()
    bare = tuple(str(name).removesuffix(".pos").removesuffix(".effort") for name in names)
    return bare if len(set(bare)) == len(bare) else tuple(map(str, names))

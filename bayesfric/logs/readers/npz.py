"""NumPy's archives, without pickles; sizes are checked before anything is unpacked."""

import io
import math
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import IO, Any

import numpy as np
import numpy.typing as npt

from bayesfric.errors import Fault, InputError
from bayesfric.logs.table import LARGEST_FILE, Log, check_cells, damaged_is_told, log_of_arrays

MOST_MEMBERS = 1000
LONGEST_HEADER = 10_000  # bytes; that of a table of many fields


def read(path: Path) -> Log:
    """Return the columns of an ``.npz`` or an ``.npy``.

    Raises
    ------
    InputError
        It is damaged, too large when it is unpacked, or has arrays of Python objects alone.
    """
    with damaged_is_told(path, "a NumPy archive"):
        arrays = {name: _array(path.name, data) for name, data in _members(path)}
        return _log(path.name, arrays)


def _members(path: Path) -> Iterator[tuple[str, bytes]]:
    """Yield the name and the content of each array."""
    if path.suffix.lower() == ".npy":
        yield "array", path.read_bytes()
        return
    with zipfile.ZipFile(path) as archive:
        _check_members(path.name, archive)
        for name in archive.namelist():
            yield name.removesuffix(".npy"), archive.read(name)


def _check_members(name: str, archive: zipfile.ZipFile) -> None:
    members = archive.infolist()
    size = sum(member.file_size for member in members)
    if len(members) > MOST_MEMBERS:
        raise InputError([Fault(name, f"at most {MOST_MEMBERS:,} arrays", value=f"{len(members)}")])
    if size > LARGEST_FILE:
        expected = f"at most {LARGEST_FILE:,} bytes when it is unpacked: cut the log"
        raise InputError([Fault(name, expected, value=f"{size:,} bytes")])


def _header(stream: IO[bytes]) -> tuple[tuple[int, ...], np.dtype[Any]]:
    version = np.lib.format.read_magic(stream)
    read_header = (
        np.lib.format.read_array_header_1_0
        if version == (1, 0)
        else np.lib.format.read_array_header_2_0
    )
    shape, _, dtype = read_header(stream, max_header_size=LONGEST_HEADER)
    return shape, dtype


def _array(name: str, data: bytes) -> npt.NDArray[Any] | None:
    """Return an array whose header says no more than the file has; None for Python objects."""
    content = io.BytesIO(data)
    shape, dtype = _header(content)
    if dtype.hasobject:
        return None
    cells = math.prod(shape)
    check_cells(name, cells)
    there = len(data) - content.tell()
    if min(shape, default=1) < 0 or cells * dtype.itemsize != there:
        expected = f"{there:,} bytes of numbers, as the file has"
        raise InputError([Fault(name, expected, value=f"{shape} of {dtype}")])
    content.seek(0)
    return np.lib.format.read_array(content, allow_pickle=False, max_header_size=LONGEST_HEADER)


def _log(name: str, arrays: Mapping[str, npt.NDArray[Any] | None]) -> Log:
    parts = {
        f"{key}.{field}" if field else key: array[field] if field else array
        for key, array in arrays.items()
        if array is not None
        for field in array.dtype.names or ("",)
    }
    left_out = ", ".join(key for key, array in arrays.items() if array is None)
    notes = [f"Arrays of Python objects are never unpickled: {left_out}."] if left_out else []
    expected = "arrays of numbers along time; Python objects are never unpickled"
    return log_of_arrays(name, parts, expected, *notes)

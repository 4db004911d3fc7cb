"""NumPy's archives, without pickles; sizes are checked before anything is unpacked."""

import io
import zipfile
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
    arrays: dict[str, npt.NDArray[Any]] = {}
    left_out: list[str] = []
    with damaged_is_told(path, "a NumPy archive"):
        if path.suffix.lower() == ".npy":
            content = path.read_bytes()
            arrays["array"] = _array(path.name, io.BytesIO(content), len(content))
        else:
            with zipfile.ZipFile(path) as archive:
                _check_members(path.name, archive)
                for member in archive.infolist():
                    name = member.filename.removesuffix(".npy")
                    with archive.open(member) as stream:
                        if _is_object(stream):
                            left_out.append(name)
                            continue
                    with archive.open(member) as stream:
                        arrays[name] = _array(path.name, stream, member.file_size)
        return _log(path.name, arrays, left_out)


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


def _is_object(stream: IO[bytes]) -> bool:
    return bool(_header(stream)[1].hasobject)


def _array(name: str, stream: IO[bytes], size: int) -> npt.NDArray[Any]:
    """Return an array whose header says no more than the file has."""
    content = io.BytesIO(stream.read(size))
    shape, dtype = _header(content)
    if dtype.hasobject:
        expected = "arrays of numbers; one of Python objects is never unpickled"
        raise InputError([Fault(name, expected)])
    cells = 1
    for length in shape:
        cells *= length
    check_cells(name, cells)
    there = size - content.tell()
    if min(shape, default=1) < 0 or cells * dtype.itemsize != there:
        expected = f"{there:,} bytes of numbers, as the file has"
        raise InputError([Fault(name, expected, value=f"{shape} of {dtype}")])
    content.seek(0)
    return np.lib.format.read_array(content, allow_pickle=False, max_header_size=LONGEST_HEADER)


def _log(name: str, arrays: dict[str, npt.NDArray[Any]], left_out: list[str]) -> Log:
    parts = {
        f"{key}.{field}" if field else key: array[field] if field else array
        for key, array in arrays.items()
        for field in array.dtype.names or ("",)
    }
    expected = "arrays of numbers along time; Python objects are never unpickled"
    note = f"Arrays of Python objects are never unpickled: {', '.join(left_out)}."
    return log_of_arrays(name, parts, expected, *((note,) if left_out else ()))

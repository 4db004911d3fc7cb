"""MATLAB's files: version 5 by SciPy, version 7.3 (HDF5) by h5py; numbers and structs of them."""

import zlib
from pathlib import Path
from typing import Any, Literal

import numpy as np

from bayesfric.errors import Fault, InputError, needs_extra
from bayesfric.logs.table import (
    LARGEST_FILE,
    Log,
    check_cells,
    damaged_is_told,
    leaves,
    log_of_arrays,
)

HDF5 = b"\x89HDF\r\n\x1a\n"
HDF5_PLACES = (0, 512)  # MATLAB puts a block of text before it
DEEPEST = 4  # structs in structs
NUMERIC = {"double", "single", "logical", "struct"} | {
    f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)
}
COMPRESSED = 15
PIECE = 1 << 20  # bytes that are unpacked at a time


def read(path: Path) -> Log:
    """Return the columns of a MAT file; what is nested in structs gets dotted names.

    Objects, functions, cells and texts of MATLAB are left out.

    Raises
    ------
    InputError
        It is damaged, too large when it is unpacked, or has no numbers along time.
    """
    with damaged_is_told(path, "a MAT file"):
        with path.open("rb") as stream:
            head = stream.read(HDF5_PLACES[-1] + len(HDF5))
        is_hdf5 = any(head[place : place + len(HDF5)] == HDF5 for place in HDF5_PLACES)
        arrays = _of_version_7(path) if is_hdf5 else _of_version_5(path)
        return log_of_arrays(path.name, arrays, "arrays of numbers along time")


def _of_version_5(path: Path) -> dict[str, Any]:
    from scipy.io import loadmat, whosmat

    _check_unpacked(path)
    names = []
    for name, shape, kind in whosmat(str(path)):
        check_cells(path.name, int(np.prod([float(length) for length in shape])))
        if kind in NUMERIC and (kind != "struct" or np.prod(shape) == 1):
            names.append(name)
    variables = loadmat(str(path), variable_names=names, simplify_cells=True)
    values = leaves({name: variables[name] for name in names}, DEEPEST)
    arrays = {
        name: np.atleast_1d(value)
        for name, value in values.items()
        if np.isscalar(value) or isinstance(value, np.ndarray)
    }
    return {name: array for name, array in arrays.items() if array.dtype.kind in "fiub"}


def _check_unpacked(path: Path) -> None:
    """Refuse a file that is too large when it is unpacked, a piece of it at a time."""
    content = path.read_bytes()
    order: Literal["big", "little"] = "big" if content[126:128] == b"MI" else "little"
    at, total = 128, 0
    while at + 8 <= len(content):
        kind = int.from_bytes(content[at : at + 4], order)
        size = int.from_bytes(content[at + 4 : at + 8], order)
        if kind == COMPRESSED:
            unpacker, rest = zlib.decompressobj(), content[at + 8 : at + 8 + size]
            while rest and not unpacker.eof:
                total += len(unpacker.decompress(rest, PIECE))
                rest = unpacker.unconsumed_tail
                if total > LARGEST_FILE:
                    expected = f"at most {LARGEST_FILE:,} bytes when it is unpacked: cut the log"
                    raise InputError([Fault(path.name, expected)])
        at += 8 + size


def _of_version_7(path: Path) -> dict[str, Any]:
    with needs_extra("logs", "an installation that reads MAT 7.3", path.name):
        import h5py
    arrays: dict[str, Any] = {}
    with h5py.File(path, "r") as file:
        _walk(path.name, h5py, file, "", 0, arrays)
    return arrays


def _walk(
    name: str, h5py: Any, group: Any, before: str, depth: int, arrays: dict[str, Any]
) -> None:
    """Put the arrays of numbers of an HDF5 group into `arrays`, as MATLAB has them."""
    for key in group:
        if key.startswith("#") or not isinstance(group.get(key, getlink=True), h5py.HardLink):
            continue  # what MATLAB keeps for itself, and links that lead out of the file
        member = group[key]
        if isinstance(member, h5py.Group) and depth < DEEPEST:
            _walk(name, h5py, member, f"{before}{key}.", depth + 1, arrays)
        elif isinstance(member, h5py.Dataset) and member.dtype.kind in "fiub":
            if member.is_virtual or member.external:
                raise InputError([Fault(name, "numbers that are in the file", column=key)])
            sizes = [int(array.size) for array in arrays.values()]
            check_cells(name, int(member.size or 0) + sum(sizes), len(arrays))
            # Characters of MATLAB are integers of two bytes.
            if member.ndim in (1, 2) and member.attrs.get("MATLAB_int_decode") != 2:
                arrays[before + key] = np.asarray(member[()]).T  # HDF5 has columns first

"""A hash behind a file's own bytes: damage is told before a library reads them.

HDF5 looks for nothing behind its end, so that a sealed netCDF file opens everywhere. A file
that is changed with such a library loses its seal, and is then read like one without.
"""

import hashlib
from pathlib import Path

__all__ = ["add_seal", "broken_seal", "has_seal"]

MARK = b"bayesfric sha256 "
LENGTH = len(MARK) + hashlib.sha256().digest_size
CHUNK = 1024**2


def add_seal(path: Path) -> None:
    """Write the hash of a file behind it."""
    digest = _digest(path, path.stat().st_size)
    with path.open("ab") as file:
        file.write(MARK + digest)


def has_seal(path: Path) -> bool:
    """Return whether a hash stands behind a file, right or wrong."""
    return _end(path).startswith(MARK)


def broken_seal(path: Path) -> bool:
    """Return whether the hash behind a file is of other bytes than those before it."""
    return _end(path) != MARK + _digest(path, path.stat().st_size - LENGTH)


def _end(path: Path) -> bytes:
    with path.open("rb") as file:
        file.seek(max(0, path.stat().st_size - LENGTH))
        return file.read()


def _digest(path: Path, size: int) -> bytes:
    found = hashlib.sha256()
    with path.open("rb") as file:
        while size > 0:
            chunk = file.read(min(CHUNK, size))
            found.update(chunk)
            size -= len(chunk)
    return found.digest()

"""A checksum at the end of a file, by which damage is found before a library reads it.

HDF5 ignores what stands behind its end, so that such a netCDF file opens everywhere. A library
that changes the file cuts the checksum off; the file is then read like one without.
"""

import hashlib
from pathlib import Path

MARK = b"bayesfric sha256 "
LENGTH = len(MARK) + hashlib.sha256().digest_size
CHUNK = 1024**2


def add_checksum(path: Path) -> None:
    """Append the SHA-256 of a file to it."""
    digest = _digest(path, path.stat().st_size)
    with path.open("ab") as file:
        file.write(MARK + digest)


def has_checksum(path: Path) -> bool:
    """Return whether a file ends with a checksum, right or wrong."""
    return _end(path).startswith(MARK)


def checksum_differs(path: Path) -> bool:
    """Return whether a file's checksum differs from that of the bytes before it."""
    return _end(path) != MARK + _digest(path, path.stat().st_size - LENGTH)


def _end(path: Path) -> bytes:
    with path.open("rb") as file:
        file.seek(max(0, path.stat().st_size - LENGTH))
        return file.read()


def _digest(path: Path, size: int) -> bytes:
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while size > 0:
            chunk = file.read(min(CHUNK, size))
            digest.update(chunk)
            size -= len(chunk)
    return digest.digest()

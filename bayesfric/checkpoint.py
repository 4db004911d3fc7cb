"""Pieces of a long computation kept on disk until the whole is done.

A piece appears whole or not at all, so a computation that is killed at any moment
finds only pieces that it can trust. Pieces of another computation (another seed,
recording, analysis or version), and pieces that do not read, are thrown away.
"""

import io
import shutil
import zipfile
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bayesfric.errors import Fault, InputError

__all__ = ["Checkpoint"]

Arrays = dict[str, NDArray[Any]]
DAMAGED = (
    OSError,
    ValueError,
    EOFError,
    KeyError,
    NotImplementedError,
    zipfile.BadZipFile,
    zlib.error,
)
"""What reading a file that is not there, cut short or altered raises."""


class Checkpoint:
    """A folder of pieces that belong to one computation.

    Parameters
    ----------
    folder : Path or None
        Where the pieces are kept; None keeps nothing.
    key : str
        Names the computation: everything on which its result depends.
    """

    def __init__(self, folder: Path | None, key: str) -> None:
        self._folder = folder
        if folder is None:
            return
        label = folder / "key"
        with _told(folder):
            if not label.is_file() or label.read_bytes() != key.encode():
                _remove(folder)
                folder.mkdir(parents=True)
                label.write_bytes(key.encode())

    def piece(self, name: str, compute: Callable[[], Arrays]) -> Arrays:
        """Return a piece: from disk if it is there, else computed and then kept.

        Parameters
        ----------
        name : str
            Names the piece; also a file name.
        compute : callable
            Returns arrays by name.

        Raises
        ------
        InputError
            The piece cannot be written.
        """
        if self._folder is None:
            return compute()
        path = self._folder / f"{name}.npz"
        kept = _read(path)
        if kept is None:
            computed = compute()
            partial = path.with_suffix(".partial")
            with _told(self._folder):
                _remove(path)
                with partial.open("wb") as stream:
                    np.savez(stream, allow_pickle=False, **computed)
                partial.replace(path)
            kept = _read(path)
            if kept is None:
                raise InputError([Fault(str(path), "a file that reads back as it was written")])
        return kept


def _read(path: Path) -> Arrays | None:
    """Return the arrays of a piece, None where there is none or it is damaged."""
    try:
        with np.load(io.BytesIO(path.read_bytes()), allow_pickle=False) as stored:
            return {key: stored[key] for key in stored.files}
    except DAMAGED:
        return None


def _remove(path: Path) -> None:
    """Remove a file, or a folder with what is in it."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


@contextmanager
def _told(folder: Path) -> Iterator[None]:
    """Tell the user of a folder that cannot be written."""
    try:
        yield
    except OSError as error:
        expected = f"a folder that can be written ({error.strerror or error})"
        raise InputError([Fault(str(folder), expected)]) from error

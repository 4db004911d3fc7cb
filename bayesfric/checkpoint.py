"""Pieces of a long computation kept on disk until the whole is done.

A piece appears whole or not at all, so a computation that is killed at any moment
finds only pieces that it can trust. Pieces of another computation (another seed,
recording, analysis, version or code), and pieces that do not read, are thrown away.
"""

import hashlib
import io
import json
import shutil
import zipfile
import zlib
from collections.abc import Callable, Mapping
from functools import cache
from itertools import count
from pathlib import Path
from typing import Any, ParamSpec, TypeVar, cast

import numpy as np
from numpy.typing import NDArray
from pydantic import ConfigDict, RootModel, TypeAdapter

from bayesfric.errors import Fault, InputError, writable
from bayesfric.files import write_whole

P = ParamSpec("P")
T = TypeVar("T")
Arrays = dict[str, NDArray[Any]]
RECORD, ARRAY = "record", "array"
"""Names of the array that says how the others make up a record, and of the place of one there."""
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
        Names the computation: everything on which its result depends but the code.
    """

    def __init__(self, folder: Path | None, key: str) -> None:
        self._folder = folder
        if folder is None:
            return
        key = f"{code_sha256()} {key}"
        label = folder / "key"
        with writable(folder):
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
            stream = io.BytesIO()
            np.savez(stream, allow_pickle=False, **computed)
            with writable(self._folder):
                _remove(path)
                write_whole(path, stream.getvalue())
            kept = _read(path)
            if kept is None:
                raise InputError([Fault(str(path), "a file that reads back as it was written")])
        return kept

    def has(self, name: str) -> bool:
        """Return whether a piece is there; one that is damaged may be."""
        return self._folder is not None and (self._folder / f"{name}.npz").is_file()

    def record(self, name: str, kind: Any, compute: Callable[[], T]) -> T:
        """Return a piece that is more than arrays.

        Parameters
        ----------
        name : str
            As of :meth:`piece`.
        kind : type
            What `compute` returns: a dataclass or a named tuple, or None beside one. Its
            fields are such again, or arrays, numbers, texts, None, tuples and mappings of these.
        compute : callable
            Returns it.

        Returns
        -------
        object
            The same, whether it was computed or kept, or nothing is kept at all.
        """
        arrays = self.piece(name, lambda: _taken_apart(compute()))
        return cast(T, _put_together(kind, json.loads(str(arrays[RECORD])), arrays))

    def keep_each_call(self, name: str, kind: Any, function: Callable[P, T]) -> Callable[P, T]:
        """Return a function of which each call is a piece, by its place among the calls.

        Parameters
        ----------
        name : str
            With which the names of the pieces begin.
        kind : type
            What the function returns, as of :meth:`record`.
        function : callable
            Called in the same order whenever the computation is run.
        """
        places = count()

        def kept(*args: P.args, **kwargs: P.kwargs) -> T:
            call = f"{name}-{next(places):04d}"
            return self.record(call, kind, lambda: function(*args, **kwargs))

        return kept


NOTHING_KEPT = Checkpoint(None, "")


@cache
def code_sha256() -> str:
    """Return the SHA-256 of the package's own source, by which a change of it is known."""
    files = sorted(Path(__file__).parent.rglob("*.py"))
    return hashlib.sha256(b"\0".join(path.read_bytes() for path in files)).hexdigest()


def _taken_apart(value: Any) -> Arrays:
    """Return the arrays of a record, and beside them all else as JSON."""
    arrays: Arrays = {}

    def plain(part: Any) -> Any:
        if isinstance(part, np.ndarray):
            name = f"array-{len(arrays)}"
            # Laid out as it will be read: sums of an array that is not whole round otherwise.
            arrays[name] = np.copy(part, order="A")
            return {ARRAY: name}
        if isinstance(part, Mapping):
            return {name: plain(item) for name, item in part.items()}
        if isinstance(part, list | tuple):
            return [plain(item) for item in part]
        return part.item() if isinstance(part, np.generic) else part

    text = json.dumps(plain(RootModel[Any](value).model_dump()))
    return {RECORD: np.array(text), **arrays}


def _put_together(kind: Any, plain: Any, arrays: Arrays) -> Any:
    """Return a record of a type."""

    def with_arrays(part: Any) -> Any:
        if isinstance(part, list):
            return [with_arrays(item) for item in part]
        if isinstance(part, dict) and ARRAY in part:
            return arrays[part[ARRAY]]
        if isinstance(part, dict):
            return {name: with_arrays(item) for name, item in part.items()}
        return part

    # in a tuple, since a dataclass alone takes no settings
    whole: Any = TypeAdapter(tuple[kind], config=ConfigDict(arbitrary_types_allowed=True))
    (record,) = whole.validate_python((with_arrays(plain),))
    return record


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

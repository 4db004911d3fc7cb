"""Pieces of a long computation kept on disk until the whole is done.

A piece appears whole or not at all, so a computation that is killed at any moment
finds only pieces that it can trust. Pieces of another computation (another seed,
recording, analysis or version) are thrown away.
"""

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Checkpoint"]

Arrays = dict[str, NDArray[Any]]


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
        if not label.is_file() or label.read_text("utf-8") != key:
            self._clear()
            folder.mkdir(parents=True)
            label.write_text(key, "utf-8")

    def piece(self, name: str, compute: Callable[[], Arrays]) -> Arrays:
        """Return a piece: from disk if it is there, else computed and then kept.

        Parameters
        ----------
        name : str
            Names the piece; also a file name.
        compute : callable
            Returns arrays by name.
        """
        if self._folder is None:
            return compute()
        path = self._folder / f"{name}.npz"
        if not path.exists():
            partial = path.with_suffix(".partial")
            with partial.open("wb") as stream:
                np.savez(stream, allow_pickle=False, **compute())
            partial.replace(path)
        with np.load(path, allow_pickle=False) as stored:
            return {key: stored[key] for key in stored.files}

    def _clear(self) -> None:
        """Remove the folder and its pieces."""
        if self._folder is not None and self._folder.exists():
            shutil.rmtree(self._folder)

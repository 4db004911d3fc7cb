"""A file to begin with, written where none is."""

from pathlib import Path

from bayesfric.errors import Fault, InputError, writable


def write_new(path: Path, text: str) -> None:
    """Write a file that is not there yet.

    Parameters
    ----------
    path : Path
        Its folder is there.
    text : str
        What it is to hold.

    Raises
    ------
    InputError
        There is a file of this name, which is left as it is, or the folder cannot be written.
    """
    with writable(path):
        if path.exists():
            raise InputError([Fault(str(path), "no file of this name; nothing is written")])
        with path.open("x", encoding="utf-8") as file:
            file.write(text)

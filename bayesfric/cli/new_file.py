"""A file to begin with, written where none is."""

from pathlib import Path

from bayesfric.errors import Fault, InputError


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
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError:
        raise InputError([Fault(str(path), "no file of this name; nothing is written")]) from None
    except OSError as error:
        expected = f"a folder that can be written ({error.strerror})"
        raise InputError([Fault(str(path), expected)]) from None

"""Bytes and TOML of a file that a user names, read within bounds."""

import re
import tomllib
from pathlib import Path
from typing import Any

from bayesfric.errors import Fault, InputError

__all__ = ["file_bytes", "read_toml"]

CAPITALS = "; true and false are written in small letters"
MEANT = re.compile(rb"=\s*(?!true|false)(?i:true|false)\b")
LARGEST_TOML = 262_144  # bytes; settings are a few kilobytes, and parsing is slow


def file_bytes(path: Path, name: str | None = None, most: int | None = None) -> bytes:
    """Return what is in a regular file.

    Parameters
    ----------
    path : Path
        The file. A pipe or a device, which might never end, is not opened.
    name : str or None
        What an error calls it; None for the path.
    most : int or None
        Bytes that it may have.

    Raises
    ------
    InputError
        It is not there, is no regular file, is too large or cannot be read.
    """
    name = str(path) if name is None else name
    try:
        if not path.is_file():
            if not path.exists():
                raise InputError([Fault(name, "a readable file (No such file or directory)")])
            found = "a folder" if path.is_dir() else "a pipe or a device"
            raise InputError([Fault(name, "a readable file", value=found)])
        size = path.stat().st_size
        if most is not None and size > most:
            expected = f"a file of at most {most:,} bytes"
            raise InputError([Fault(name, expected, value=f"{size:,} bytes")])
        return path.read_bytes()
    except (OSError, RuntimeError) as error:  # RuntimeError: a loop of symbolic links
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError([Fault(name, f"a readable file ({reason})")]) from error


def read_toml(path: Path) -> dict[str, Any]:
    """Return the keys of a TOML file.

    Parameters
    ----------
    path : Path
        The file.

    Raises
    ------
    InputError
        It cannot be read, is not UTF-8 or is not TOML: where, and why.
    """
    name = path.name
    data = file_bytes(path, name, LARGEST_TOML)
    try:
        return tomllib.loads(data.decode("utf-8"))
    except UnicodeDecodeError as error:
        row = data.count(b"\n", 0, error.start) + 1
        raise InputError([Fault(name, "a file in UTF-8", row=row)]) from error
    except tomllib.TOMLDecodeError as error:
        why = f"{error}{CAPITALS if MEANT.search(data) else ''}"
        raise InputError([Fault(name, f"TOML that parses ({why})")]) from error
    except RecursionError as error:
        raise InputError([Fault(name, "TOML that is not nested so deeply")]) from error
    except ValueError as error:  # Python's limit of 4,300 digits
        raise InputError([Fault(name, "TOML with numbers of reasonable length")]) from error

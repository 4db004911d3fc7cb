"""Files: a user's read within bounds; ours written whole, with a checksum behind them.

HDF5 ignores what stands behind its end, so that a netCDF file with a checksum there opens
everywhere. A library that changes the file cuts it off; the file is then read like one without.
"""

import hashlib
import re
import signal
import threading
import tomllib
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any, get_args
from xml.etree import ElementTree

from bayesfric.errors import Fault, InputError, near, one_of

MARK = b"bayesfric sha256 "
LENGTH = len(MARK) + hashlib.sha256().digest_size
CHUNK = 1024**2
CAPITALS = "; true and false are written in small letters"
MEANT = re.compile(rb"=\s*(?!true|false)(?i:true|false)\b")
PLACES_SHOWN = 3  # places of a key that can be told
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
            kind = "a folder" if path.is_dir() else "a pipe or a device"
            raise InputError([Fault(name, "a readable file", value=kind)])
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
        return tomllib.loads(data.decode("utf-8-sig"))
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


def xml_root(content: bytes, name: str) -> ElementTree.Element:
    """Return the root element of an XML file.

    Parameters
    ----------
    content : bytes
        The file.
    name : str
        What an error calls it.

    Raises
    ------
    InputError
        It is no XML, or declares entities, which may be endless.
    """
    if b"<!DOCTYPE" in content or b"<!ENTITY" in content:
        raise InputError([Fault(name, "XML without entities (<!DOCTYPE … >)")])
    try:
        return ElementTree.fromstring(content)
    except (ElementTree.ParseError, ValueError, LookupError) as error:  # an unknown encoding
        raise InputError([Fault(name, f"XML that parses ({error})")]) from error


def key_faults(
    file: str, error: Any, page: str, model: Any, tags: Collection[str] = ()
) -> list[Fault]:
    """Return what is wrong at the keys of a TOML file, each in words of its own.

    Parameters
    ----------
    file : str
        Its name.
    error : pydantic.ValidationError
        What is wrong.
    page : str
        Of the documentation, which has all keys.
    model : type of pydantic.BaseModel
        What the file should be.
    tags : collection of str
        Parts of a place that are no keys, but which of several kinds of table it is.
    """
    keys = tuple(dict.fromkeys(_keys(model)))
    faults: list[Fault] = []
    for detail in error.errors():
        key = ".".join(str(part) for part in detail["loc"] if part not in tags)
        if detail["type"] == "extra_forbidden":
            faults.append(_unknown(file, key, page, keys))
        elif detail["type"] == "missing":
            faults.append(Fault(file, f"this key (see {page})", column=key))
        else:
            faults.append(_wrong(file, key, page, detail))
    meant = " ".join(fault.expected for fault in faults)  # a misspelt key is not missing too
    return [fault for fault in faults if f"; is {fault.column!r} meant" not in meant]


def _keys(model: Any, before: str = "") -> Iterator[str]:
    """Yield the keys of a model, dotted, those of tables in it too."""
    for name, field in model.model_fields.items():
        yield before + name
        yield from _inner(field.annotation, f"{before}{name}.")


def _inner(kind: Any, before: str) -> Iterator[str]:
    if hasattr(kind, "model_fields"):
        yield from _keys(kind, before)
    for part in get_args(kind):
        yield from _inner(part, before)


def _unknown(file: str, key: str, page: str, keys: Collection[str]) -> Fault:
    """Return the fault of an unknown key, with the table or the spelling that may be meant."""
    last = key.rpartition(".")[2]
    own = [candidate for candidate in keys if candidate.rpartition(".")[2] == last]
    hint = f"; is {' or '.join(map(repr, own))} meant?" if 0 < len(own) <= PLACES_SHOWN else ""
    return Fault(file, f"no such key (see {page}){hint or _misspelt(key, keys)}", column=key)


def _misspelt(key: str, keys: Collection[str]) -> str:
    table, _, last = key.rpartition(".")
    same = [
        candidate
        for candidate in keys
        if candidate.rpartition(".")[0] == table and candidate != key
    ]
    return "" if key in keys else near(key, same) or near(last, keys)


def _wrong(file: str, key: str, page: str, detail: Any) -> Fault:
    """Return what is wrong with a value."""
    value = detail["input"]
    if detail["type"].startswith("union_tag"):
        asked = f"{key}.{detail['ctx']['discriminator'].strip(chr(39))}"
        if detail["type"] == "union_tag_not_found":
            return Fault(file, f"this key (see {page})", column=asked)
        names = detail["ctx"]["expected_tags"].replace("'", "").split(", ")
        tag = str(detail["ctx"]["tag"])
        return Fault(file, one_of(names, tag), column=asked, value=tag)
    if detail["type"] in ("model_attributes_type", "model_type", "dict_type"):
        return Fault(file, f"a table of keys (see {page})", column=key, value=str(value))
    message = detail["msg"].removeprefix("Value error, ").removeprefix("Input should be ")
    shown = None if isinstance(value, dict) or hasattr(value, "model_dump") else str(value)
    return Fault(file, message.partition(", unable")[0], column=key or None, value=shown)


def write_whole(path: Path, content: bytes) -> None:
    """Write a file that appears whole or not at all, whenever the process is killed."""
    partial = path.with_name(f"{path.name}.partial")
    partial.write_bytes(content)
    partial.replace(path)


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


@contextmanager
def handling(handler: Callable[[int, FrameType | None], object]) -> Iterator[None]:
    """Call a handler on SIGINT and SIGTERM within the block, except where they are ignored."""
    if threading.current_thread() is not threading.main_thread():
        yield  # only the main thread is interrupted
        return
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    for number, own in before.items():
        if own is not signal.SIG_IGN:
            signal.signal(number, handler)
    try:
        yield
    finally:
        for number, own in before.items():
            signal.signal(number, signal.SIG_DFL if own is None else own)


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Defer SIGINT and SIGTERM to the end of the block."""
    came: list[int] = []
    with handling(lambda number, _: came.append(number)):
        yield
    for first in came[:1]:
        signal.raise_signal(first)

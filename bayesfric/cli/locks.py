"""A lock on the folder that a verb writes into, so that two runs never mix their files."""

import importlib
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from bayesfric.errors import Fault, InputError, writable

LOCK = ".lock"
BEHIND = 1 << 20  # byte that Windows locks: behind all that the file says, which stays readable


@contextmanager
def hold(folder: Path, verb: str) -> Iterator[None]:
    """Keep other runs out of a folder.

    The operating system lets go of the lock of a process that ends, however it ends, so that
    a stale one holds nobody up. The file says whose the lock is, and is removed at the end.

    Parameters
    ----------
    folder : Path
        Created if it is not there, and removed again if nothing was written.
    verb : str
        Who holds it.

    Raises
    ------
    InputError
        Another run holds it, or the folder cannot be made or written.
    """
    if (folder / "datapackage.json").exists():
        raise InputError([Fault(str(folder), "a folder for results; this one is a recording")])
    made = [parent for parent in (folder, *folder.parents) if not parent.exists()]
    with writable(folder):
        try:
            folder.mkdir(parents=True, exist_ok=True)
            descriptor = _lock(folder / LOCK)
        except FileExistsError as error:
            raise InputError([Fault(str(folder), "a folder, not a file, to write into")]) from error
    try:
        owner = f"process {os.getpid()} on {socket.gethostname()}, bayesfric {verb}"
        os.truncate(descriptor, 0)
        os.write(descriptor, owner.encode())
        yield
    finally:
        removed = _remove(folder / LOCK)
        os.close(descriptor)
        if not removed:  # Windows removes no file that is open
            _remove(folder / LOCK)
        with suppress(OSError):
            for parent in made:
                parent.rmdir()


def _remove(path: Path) -> bool:
    """Remove a file, and return whether that was possible."""
    try:
        path.unlink()
    except OSError:
        return False
    return True


def _take(descriptor: int) -> None:
    """Lock a file, or raise the error of the operating system where another process has."""
    try:
        posix: Any = importlib.import_module("fcntl")
    except ModuleNotFoundError:
        windows: Any = importlib.import_module("msvcrt")
        os.lseek(descriptor, BEHIND, os.SEEK_SET)
        try:
            windows.locking(descriptor, windows.LK_NBLCK, 1)
        finally:
            os.lseek(descriptor, 0, os.SEEK_SET)
    else:
        posix.flock(descriptor, posix.LOCK_EX | posix.LOCK_NB)


def _lock(path: Path) -> int:
    """Return the descriptor of a locked file that is still in its place."""
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            _take(descriptor)
        except (BlockingIOError, PermissionError) as error:
            owner = os.read(descriptor, 300).decode(errors="replace") or "another process"
            os.close(descriptor)
            expected = f"a folder into which no other run writes, and {owner} does"
            raise InputError([Fault(str(path.parent), expected)]) from error
        except BaseException:
            os.close(descriptor)
            raise
        # Whoever had it may have removed the file in between: then it locks nothing.
        if path.exists() and os.path.samestat(os.fstat(descriptor), path.stat()):
            return descriptor
        os.close(descriptor)

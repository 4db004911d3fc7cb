"""The environment that a verb is started in: what the libraries below would trip over.

Neither where caches may lie nor which window a notebook draws in changes a result. Worker
processes inherit what is set here.
"""

import atexit
import os
import shutil
import tempfile
from pathlib import Path

from bayesfric.source_date import SOURCE_DATE_EPOCH, source_date


def prepare() -> None:
    """Set variables of the environment aside that no result depends on, before any import.

    Raises
    ------
    InputError
        ``SOURCE_DATE_EPOCH`` is no number of seconds: NumPy and the report both read it.
    """
    if source_date() is None:
        os.environ.pop(SOURCE_DATE_EPOCH, None)  # NumPy cannot read an empty one
    os.environ["MPLBACKEND"] = "agg"  # figures are files: a notebook's window is of no use
    unusable = [name for name, folder in _folders().items() if not _can_write(folder)]
    if unusable:
        scratch = tempfile.mkdtemp(prefix="bayesfric-")
        atexit.register(shutil.rmtree, scratch, ignore_errors=True)
        os.environ.update(dict.fromkeys(unusable, scratch))


def _folders() -> dict[str, Path | None]:
    """Return where libraries keep caches and settings, by the variable that says so."""
    try:
        home: Path | None = Path.home()
    except RuntimeError:  # neither a variable nor an entry among the users, as in a container
        home = None
    config = os.environ.get("XDG_CONFIG_HOME") or (home and home / ".config")
    figures = os.environ.get("MPLCONFIGDIR") or (config and Path(config) / "matplotlib")
    cache = os.environ.get("XDG_CACHE_HOME") or (home and home / ".cache")
    places = {"MPLCONFIGDIR": figures, "XDG_CACHE_HOME": cache}
    folders = {name: None if path is None else Path(path) for name, path in places.items()}
    return folders if home is not None else {"HOME": None, **folders}


def _can_write(folder: Path | None) -> bool:
    """Return whether a folder can be written, or made if it is not there."""
    if folder is None:
        return False
    try:
        nearest = next(parent for parent in (folder, *folder.parents) if parent.exists())
        Path(tempfile.mkdtemp(prefix=".bayesfric-", dir=nearest)).rmdir()
    except OSError:
        return False
    return True

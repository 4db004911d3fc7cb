"""Logs of every kind, altered at random: each is imported, or refused with InputError."""

import tempfile
from functools import cache, partial
from pathlib import Path

import numpy as np
from fuzzing.mutants import Alter, altered
from logs.written import ENDS, MAPPINGS, write

from bayesfric.logs import import_log, propose_mapping
from bayesfric.recording import write_recording

ROWS = 12


def log(end: str, random: np.random.Generator, folder: Path) -> None:
    files, place = whole(end)
    files = dict(files)
    name = sorted(files)[random.integers(len(files))]
    files[name] = altered(files[name], random)
    for file, content in files.items():
        (folder / file).parent.mkdir(parents=True, exist_ok=True)
        (folder / file).write_bytes(content)
    mapping = folder / "map.toml"
    mapping.write_text(MAPPINGS[end], encoding="utf-8")
    propose_mapping(folder / place)
    made = import_log(folder / place, "elbow", mapping=mapping)
    write_recording(made.recording, folder / "made")


@cache
def whole(end: str) -> tuple[dict[str, bytes], str]:
    """Return the files of a log by their place, and that of the log."""
    with tempfile.TemporaryDirectory() as kept:
        path = write(Path(kept), end, rows=ROWS)
        inside = path if path.is_dir() else Path(kept)
        files = [file for file in inside.rglob("*") if file.is_file()]
        if end == "mcap":
            files = [path]
        contents = {str(file.relative_to(kept)): file.read_bytes() for file in files}
        return contents, str(path.relative_to(kept))


LOG_KINDS: dict[str, Alter] = {end: partial(log, end) for end in ENDS}

"""Kinds of logs, a file each: ``read(path, …)`` makes a :class:`bayesfric.logs.table.Log`."""

from collections.abc import Collection
from pathlib import Path

from bayesfric.errors import Fault, InputError
from bayesfric.logs.mapping import CsvForm
from bayesfric.logs.readers import csv, json, mat, mcap, npz, parquet, ros2
from bayesfric.logs.table import LARGEST_FILE, Log

__all__ = ["KINDS", "kind_of", "read_log"]

KINDS = {
    ".csv": "csv",
    ".tsv": "csv",
    ".txt": "csv",
    ".log": "csv",
    ".dat": "csv",
    ".json": "json",
    ".jsonl": "json",
    ".ndjson": "json",
    ".npz": "npz",
    ".npy": "npz",
    ".mat": "mat",
    ".parquet": "parquet",
    ".mcap": "mcap",
    ".db3": "ros2",
}
"""Kind of a log by how its name ends."""


def kind_of(path: Path) -> str:
    """Return the kind of a log.

    Raises
    ------
    InputError
        It is not there, is of no kind, or is too large.
    """
    if path.is_dir():
        if (path / "metadata.yaml").is_file():
            return "ros2"
        expected = "a ROS 2 bag, a folder with metadata.yaml, or a file"
        raise InputError([Fault(str(path), expected, value="a folder without it")])
    kinds = f"a log: a file that ends in {', '.join(KINDS)}, or the folder of a ROS 2 bag"
    if not path.is_file():
        raise InputError([Fault(str(path), kinds, value="no such file")])
    kind = KINDS.get(path.suffix.lower())
    if kind is None:
        raise InputError([Fault(str(path), kinds, value=path.suffix or path.name)])
    size = path.stat().st_size
    if size > LARGEST_FILE and kind not in ("mcap", "ros2"):  # of these a few topics are read
        expected = f"a file of at most {LARGEST_FILE:,} bytes: cut the log"
        raise InputError([Fault(path.name, expected, value=f"{size:,} bytes")])
    return kind


def read_log(path: Path, form: CsvForm | None, wanted: Collection[str | int] | None = None) -> Log:
    """Return a log's columns.

    Parameters
    ----------
    path : Path
        A file, or a ROS 2 bag's folder.
    form : CsvForm or None
        How a CSV is written; refused for other kinds. None is the usual.
    wanted : collection of str or int, or None
        Columns by name or number, if not all are needed; a kind may read more.

    Raises
    ------
    InputError
        It cannot be read: where and why.
    """
    kind = kind_of(path)
    if kind == "csv":
        return csv.read(path, form or CsvForm(), wanted)
    if form is not None:
        expected = "a CSV file, where the mapping has [csv]"
        raise InputError([Fault(path.name, expected, value=f"a log of the kind {kind}")])
    read = {"json": json, "npz": npz, "mat": mat, "mcap": mcap, "ros2": ros2}
    return parquet.read(path, wanted) if kind == "parquet" else read[kind].read(path)

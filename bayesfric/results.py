"""Draws and provenance on disk: netCDF that ArviZ opens, and JSON. No pickles.

Files appear whole or not at all: a verb prepares all of its outputs in a folder
beside the target and then renames them into place.
"""

import hashlib
import math
import platform
import shutil
from collections.abc import Callable, Iterator, Mapping
from importlib import metadata
from pathlib import Path
from typing import Any, Literal, TypeAlias, TypeVar

import netCDF4
import numpy as np
import xarray as xr
from numpy.typing import NDArray
from pydantic import BaseModel, ValidationError

from bayesfric.analysis import Analysis, settings_sha256
from bayesfric.chains import with_chains
from bayesfric.errors import Fault, InputError, writable
from bayesfric.files import add_checksum, checksum_differs, file_bytes, has_checksum, uninterrupted
from bayesfric.recording.digest import rig_sha256
from bayesfric.recording.tables import Recording
from bayesfric.schemas.base import Provenance, RecordingId
from bayesfric.source_date import source_date
from bayesfric.stored_names import restored, storable, variable_of

Record = TypeVar("Record", bound=BaseModel)
Value = TypeVar("Value")
File = TypeVar("File", bound=Provenance)
Output: TypeAlias = BaseModel | bytes | Callable[[Path], object]
ARRAYS = {
    "fit.json": ("draws.nc", "predictive.nc"),
    "claims.json": ("claims.nc",),
    "diagnosis.json": ("diagnosis.nc",),
}
"""What each JSON file is written with."""
VERBS = {
    "fit.json": "fit RECORDING",
    "claims.json": "claims RECORDING",
    "diagnosis.json": "diagnose RECORDING",
    "margins.json": "margins LOOP.toml --draws DRAWS.nc",
    "scorecard.json": "blind",
    "calibration.json": "calibrate",
}
"""By which a JSON file of another version is made anew."""
ENGINE: Literal["netcdf4"] = "netcdf4"
"""Of xarray: it reads and writes eight times faster than h5netcdf does."""
LARGEST_ARRAY = 1024**3  # bytes; draws.nc has 20 MB
PACKAGES = ("bayesfric", "arviz-base", "arviz-stats", "emcee", "numpy", "scipy", "xarray")


def recording_id(recording: Recording) -> RecordingId:
    """Return which recording results rest on: its tables and its rig."""
    name, title, rig = recording.name, recording.title, rig_sha256(recording.rig)
    return RecordingId(name=name, title=title, sha256=recording.sha256, rig_sha256=rig)


def provenance(*, recording: RecordingId, analysis: Analysis, created: str | None) -> Provenance:
    """Return the provenance that every file carries.

    Parameters
    ----------
    recording : RecordingId
        Name, title and hash of the recording.
    analysis : Analysis
        The settings, and the seed.
    created : str or None
        The recording's own date; ``SOURCE_DATE_EPOCH`` overrides it.
    """
    return Provenance(
        seed=analysis.seed,
        versions=package_versions(),
        recording=recording,
        analysis_sha256=settings_sha256(analysis),
        analysis=analysis.model_dump(mode="json"),
        created=created_date(created),
    )


def provenance_of(recording: Recording, analysis: Analysis) -> Provenance:
    """Return the provenance of a result that rests on one recording."""
    identity = recording_id(recording)
    return provenance(recording=identity, analysis=analysis, created=recording.created)


def package_versions() -> dict[str, str]:
    """Return the version of Python and of each package on which numbers depend."""
    return {
        "python": platform.python_version(),
        **{name: metadata.version(name) for name in PACKAGES},
    }


def created_date(fallback: str | None) -> str | None:
    """Return ``SOURCE_DATE_EPOCH`` as ISO 8601, else the fallback.

    Raises
    ------
    InputError
        The variable is set to something that is not a number of seconds.
    """
    date = source_date()
    return fallback if date is None else date.strftime("%Y-%m-%dT%H:%M:%SZ")


def draws_tree(
    groups: Mapping[str, Mapping[str, NDArray[Any]]],
    *,
    dims: Mapping[str, list[str]],
    coords: Mapping[str, Any],
    ensembles: int,
    attributes: Mapping[str, Any],
    units: Mapping[str, str] | None = None,
) -> xr.DataTree:
    """Lay draws out as ArviZ does.

    Parameters
    ----------
    groups : mapping
        Group to variable to array of shape (ensemble × walker, step, …); of data without
        draws, (…).
    dims, coords : mapping
        Names of the further dimensions of each variable, and their values.
    ensembles : int
        Each becomes a chain (:mod:`bayesfric.chains`).
    attributes : mapping
        Provenance, written on the root.
    units : mapping of str to str, or None
        Of variables, by name.

    Returns
    -------
    DataTree
        Without the date that ArviZ would stamp on it.
    """
    import arviz_base  # late: it loads matplotlib, which reading a recording has no use for

    tree = arviz_base.from_dict(
        {name: _by_variable(group) for name, group in groups.items()},
        dims=_by_variable(dims),
        coords=dict(coords),
        check_conventions=False,  # by walker, where more chains than draws are meant
    )
    for name in groups:
        group = tree[name].to_dataset()
        if group.sizes.get("chain", 1) > 1:  # the prior has no ensembles
            group = with_chains(group, ensembles)
        group.attrs = {}
        by_variable = _by_variable(units or {})
        for variable in group.data_vars.keys() & by_variable.keys():
            group[variable].attrs["units"] = by_variable[str(variable)]
        tree[name] = xr.DataTree(group)
    tree.attrs = dict(attributes)
    return tree


def _by_variable(named: Mapping[str, Value]) -> dict[str, Value]:
    return {variable_of(name): value for name, value in named.items()}


def identified(record: File) -> File:
    """Return a record with its run id, a hash of all else that it says.

    The same seed, recording and settings give the same id; files of two runs that differ
    in anything never share one.
    """
    data = record.model_copy(update={"run_id": ""}).model_dump_json(by_alias=True)
    return record.model_copy(update={"run_id": hashlib.sha256(data.encode()).hexdigest()[:16]})


def write_netcdf(tree: xr.DataTree, path: Path, run_id: str = "") -> None:
    """Write a tree as netCDF-4, compressed, with its run id and a checksum, without times."""
    tree, layout = storable(tree), _layout(tree)
    tree.attrs = tree.attrs | {"run_id": run_id, "layout": layout}
    encoding = {
        f"/{node.path.strip('/')}": {
            # Where the checksum of the file is lost, those of its arrays are left.
            str(name): {"zlib": True, "complevel": 2, "shuffle": True, "fletcher32": True}
            for name, variable in node.data_vars.items()
            if variable.dtype.kind == "f" and variable.size > 1
        }
        for node in tree.subtree
    }
    with uninterrupted():  # xarray would wait for ever for the lock of a write that was cut off
        tree.to_netcdf(path, engine=ENGINE, encoding=encoding)
    add_checksum(path)


def json_bytes(record: BaseModel) -> bytes:
    """Return a record as JSON, two-space indented, with a newline at the end."""
    return (record.model_dump_json(indent=2, by_alias=True) + "\n").encode()


def replace_outputs(folder: Path, outputs: Mapping[str, Output]) -> None:
    """Write several files, all of them or none.

    They are prepared beside the target and renamed in the given order. Renaming cannot be
    done at once: a kill between two names leaves a set of two runs, which every reader
    refuses by its run ids (:func:`read_beside`).

    Parameters
    ----------
    folder : Path
        Created if it is not there; files of other names are left alone.
    outputs : mapping of str to record, bytes or callable
        File name to what it holds, a record as JSON, or to what writes the path it is given.

    Raises
    ------
    InputError
        The folder cannot be made or written.
    """
    with writable(folder):
        folder.mkdir(parents=True, exist_ok=True)
        if folders := [name for name in outputs if (folder / name).is_dir()]:
            raise InputError([Fault(str(folder / name), "no folder here") for name in folders])
        scratch = folder / ".writing"
        shutil.rmtree(scratch, ignore_errors=True)  # of a run that was killed here
        scratch.mkdir()
        try:
            for name, output in outputs.items():
                if isinstance(output, BaseModel | bytes):
                    data = output if isinstance(output, bytes) else json_bytes(output)
                    (scratch / name).write_bytes(data)
                else:
                    output(scratch / name)
            for name in outputs:
                (scratch / name).replace(folder / name)
        finally:
            shutil.rmtree(scratch)


def write_result(folder: Path, name: str, record: Provenance, curves: xr.DataTree) -> None:
    """Write ``name.json`` and the arrays beside it, ``name.nc``, both or neither.

    Raises
    ------
    InputError
        The folder cannot be made or written.
    """
    outputs: dict[str, Output] = {
        f"{name}.nc": lambda path: write_netcdf(curves, path, record.run_id),
        f"{name}.json": record,
    }
    replace_outputs(folder, outputs)


def read_tree(path: Path) -> xr.DataTree:
    """Read a netCDF tree into memory.

    Raises
    ------
    InputError
        The file is missing, is not netCDF, is damaged, or lacks a part that it was
        written with.
    """
    try:
        if not path.is_file():
            raise InputError([_not_netcdf(path, "a folder" if path.is_dir() else "no such file")])
        _check_bytes(path)
        with xr.open_datatree(path, engine=ENGINE) as tree:
            restored_tree = restored(tree.load())
    except InputError:
        raise
    except Exception as error:  # whatever the libraries make of bytes that are damaged
        raise InputError([_not_netcdf(path, "it cannot be read as one")]) from error
    if restored_tree.attrs.get("layout", _layout(restored_tree)) != _layout(restored_tree):
        raise InputError([_not_netcdf(path, "a part of it is missing")])
    return restored_tree


def _check_bytes(path: Path) -> None:
    """Raise where the checksum is wrong or an array has an absurd size."""
    if has_checksum(path) and checksum_differs(path):
        raise ValueError("its bytes have changed")
    with netCDF4.Dataset(path) as file:
        for variable in _variables(file):
            size = math.prod(variable.shape) * max(1, np.dtype(variable.dtype).itemsize)
            if size > LARGEST_ARRAY:
                raise ValueError(f"{variable.name} has {size:,} bytes")


def _variables(group: netCDF4.Dataset | netCDF4.Group) -> Iterator["netCDF4.Variable[Any]"]:
    """Yield the variables of a group and of all groups in it."""
    yield from group.variables.values()
    for child in group.groups.values():
        yield from _variables(child)


def _layout(tree: xr.DataTree) -> str:
    """Return a hash of the groups, variables, dimensions and shapes of a tree."""
    parts = [
        f"{node.path} {name} {variable.dims} {variable.shape}"
        for node in tree.subtree
        for name, variable in node.to_dataset(inherit=False).variables.items()
    ]
    return hashlib.sha256("\n".join(sorted(parts)).encode()).hexdigest()[:16]


def _not_netcdf(path: Path, why: str) -> Fault:
    return Fault(str(path), f"a netCDF file that bayesfric wrote, whole ({why})")


def read_json(model: type[Record], path: Path, verb: str | None = None) -> Record:
    """Read a JSON file of a known schema; the error of a missing one names the verb that writes it.

    Raises
    ------
    InputError
        The file is missing or does not follow its schema: at which keys.
    """
    if verb is not None and not path.is_file():
        expected = f"it in {path.parent}: run `bayesfric {verb} RECORDING -o {path.parent}`"
        raise InputError([Fault(path.name, expected)])
    try:
        return model.model_validate_json(file_bytes(path))
    except ValidationError as error:
        faults = sorted(error.errors(), key=lambda fault: fault["loc"] != ("schema",))
        several = faults if faults[0]["loc"] != ("schema",) else faults[:1]  # all else follows
        raise InputError([_unlike(path, model, fault) for fault in several]) from error


def _unlike(path: Path, model: type[BaseModel], detail: Any) -> Fault:
    key = ".".join(map(str, detail["loc"])) or None
    if key == "schema":
        wanted = f"a file of {model.model_fields['schema_'].default}"
        if verb := VERBS.get(path.name):
            wanted += f": run `bayesfric {verb} -o {path.parent}` again"
        return Fault(str(path), wanted, column=key, value=str(detail["input"]))
    return Fault(str(path), f"a file that bayesfric writes ({detail['msg']})", column=key)


def read_beside(record: Provenance, path: Path) -> xr.DataTree:
    """Read the arrays that were written with a record.

    Parameters
    ----------
    record : Provenance
        Of the JSON file beside it.
    path : Path
        The netCDF file.

    Raises
    ------
    InputError
        It is missing, is not netCDF, or is of another run.
    """
    tree = read_tree(path)
    if tree.attrs.get("run_id", "") != record.run_id:
        expected = "a file of the same run as the JSON beside it: run the verb again"
        raise InputError([Fault(str(path), expected)])
    return tree


def refuse_mixed(record: Provenance, path: Path) -> None:
    """Refuse a JSON file whose arrays, where they are beside it, are of another run.

    Parameters
    ----------
    record : Provenance
        As read.
    path : Path
        Where it was read.

    Raises
    ------
    InputError
        The files are of two runs, or arrays are damaged.
    """
    for name in ARRAYS.get(path.name, ()):
        beside = path.with_name(name)
        if beside.is_file() and _run_id(beside) != record.run_id:
            expected = f"a file of the same run as {path.name}: run the verb again"
            raise InputError([Fault(str(beside), expected)])


def _run_id(path: Path) -> str:
    try:
        if not has_checksum(path):  # damage of its arrays shows only when they are read
            return str(read_tree(path).attrs.get("run_id", ""))
        _check_bytes(path)
        with netCDF4.Dataset(path) as file:
            return str(getattr(file, "run_id", ""))
    except InputError:
        raise
    except Exception as error:  # as in read_tree
        raise InputError([_not_netcdf(path, "it cannot be read as one")]) from error

"""Draws and provenance on disk: netCDF that ArviZ opens, and JSON. No pickles.

Files appear whole or not at all: a verb prepares all of its outputs in a folder
beside the target and then renames them into place.
"""

import os
import platform
import shutil
from collections.abc import Callable, Mapping
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import Any, TypeVar

import arviz_base
import h5netcdf  # noqa: F401  (the engine; imported so that its absence shows at once)
import numpy as np
import xarray as xr
from numpy.typing import NDArray
from pydantic import BaseModel

from bayesfric.errors import Fault, InputError
from bayesfric.physics.friction import Coefficients
from bayesfric.schemas import FitFile, Provenance, RecordingId

__all__ = [
    "created_date",
    "draws_tree",
    "fitted_coefficients",
    "json_bytes",
    "package_versions",
    "provenance",
    "read_json",
    "read_tree",
    "replace_outputs",
    "write_netcdf",
]

Array = NDArray[np.float64]
Record = TypeVar("Record", bound=BaseModel)
PACKAGES = ("bayesfric", "arviz-base", "arviz-stats", "emcee", "numpy", "scipy", "xarray")


def provenance(
    *,
    seed: int,
    recording: RecordingId,
    analysis_sha256: str,
    created: str | None,
) -> Provenance:
    """Return what every file carries.

    Parameters
    ----------
    seed : int
        Of the analysis.
    recording : RecordingId
        Name, title and hash of the recording.
    analysis_sha256 : str
        Hash of the settings.
    created : str or None
        The recording's own date; ``SOURCE_DATE_EPOCH`` overrides it.
    """
    return Provenance(
        seed=seed,
        versions=package_versions(),
        recording=recording,
        analysis_sha256=analysis_sha256,
        created=created_date(created),
    )


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
    epoch = os.environ.get("SOURCE_DATE_EPOCH")
    if epoch is None:
        return fallback
    try:
        moment = datetime.fromtimestamp(int(epoch), UTC)
    except (ValueError, OverflowError, OSError) as error:
        expected = "whole seconds since 1970"
        fault = Fault("environment", expected, column="SOURCE_DATE_EPOCH", value=epoch)
        raise InputError([fault]) from error
    return moment.strftime("%Y-%m-%dT%H:%M:%SZ")


def draws_tree(
    groups: Mapping[str, Mapping[str, NDArray[Any]]],
    *,
    dims: Mapping[str, list[str]],
    coords: Mapping[str, Any],
    ensemble: NDArray[np.int_],
    attributes: Mapping[str, Any],
    units: Mapping[str, str] | None = None,
) -> xr.DataTree:
    """Lay draws out as ArviZ does.

    Parameters
    ----------
    groups : mapping
        Group to variable to array of shape (chain, draw, …); of data without draws, (…).
    dims, coords : mapping
        Names of the further dimensions of each variable, and their values.
    ensemble : ndarray of int, shape (chain,)
        The ensemble of each chain; chain = ensemble × walker.
    attributes : mapping
        Provenance, written on the root.
    units : mapping of str to str, or None
        Of variables, by name.

    Returns
    -------
    DataTree
        Without the date that ArviZ would stamp on it.
    """
    tree = arviz_base.from_dict(
        {name: dict(group) for name, group in groups.items()},
        dims=dict(dims),
        coords=dict(coords),
        check_conventions=False,  # many walkers: more chains than draws is meant
    )
    for name in groups:
        group = tree[name].to_dataset()
        if group.sizes.get("chain") == len(ensemble):  # the prior has no ensembles
            group = group.assign_coords(ensemble=("chain", ensemble))
        group.attrs = {}
        for variable in group.data_vars.keys() & (units or {}).keys():
            group[variable].attrs["units"] = (units or {})[str(variable)]
        tree[name] = xr.DataTree(group)
    tree.attrs = dict(attributes)
    return tree


def write_netcdf(tree: xr.DataTree, path: Path) -> None:
    """Write a tree as netCDF-4, compressed, without creation times."""
    encoding = {
        f"/{node.path.strip('/')}": {
            str(name): {"zlib": True, "complevel": 4, "shuffle": True}
            for name, variable in node.data_vars.items()
            if variable.dtype.kind == "f" and variable.size > 1
        }
        for node in tree.subtree
    }
    tree.to_netcdf(path, engine="h5netcdf", encoding=encoding)


def json_bytes(record: BaseModel) -> bytes:
    """Return a record as JSON, two-space indented, with a newline at the end."""
    return (record.model_dump_json(indent=2, by_alias=True) + "\n").encode()


def replace_outputs(folder: Path, writers: Mapping[str, Callable[[Path], object]]) -> None:
    """Write several files, all of them or none.

    Parameters
    ----------
    folder : Path
        Created if it is not there; files of other names are left alone.
    writers : mapping of str to callable
        File name to a function that writes the path it is given.

    Raises
    ------
    InputError
        The folder cannot be made or written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        scratch = folder / ".writing"
        shutil.rmtree(scratch, ignore_errors=True)  # of a run that was killed here
        scratch.mkdir()
        try:
            for name, write in writers.items():
                write(scratch / name)
            for name in writers:
                (scratch / name).replace(folder / name)
        finally:
            shutil.rmtree(scratch)
    except OSError as error:
        problem = f"a folder that can be written ({error.strerror or error})"
        raise InputError([Fault(str(folder), problem)]) from error


def read_tree(path: Path) -> xr.DataTree:
    """Read a netCDF tree into memory.

    Raises
    ------
    InputError
        The file is missing or is not netCDF.
    """
    try:
        with xr.open_datatree(path, engine="h5netcdf") as tree:
            return tree.load()
    except (OSError, ValueError) as error:
        fault = Fault(path.name, "a netCDF file that bayesfric wrote")
        raise InputError([fault]) from error


def read_json(model: type[Record], path: Path) -> Record:
    """Read a JSON file of a known schema.

    Raises
    ------
    InputError
        The file is missing or does not follow its schema.
    """
    try:
        return model.model_validate_json(path.read_bytes())
    except (OSError, ValueError) as error:
        fault = Fault(path.name, f"a file of the schema that bayesfric writes ({error})")
        raise InputError([fault]) from error


def fitted_coefficients(folder: Path) -> dict[str, Coefficients]:
    """Return the posterior means of a stored fit, by pulley size.

    Parameters
    ----------
    folder : Path
        Where ``fit.json`` is.

    Raises
    ------
    InputError
        There is no fit.
    """
    pulleys = read_json(FitFile, folder / "fit.json").pulleys
    return {
        size: Coefficients(*(entries[name].mean for name in Coefficients._fields))
        for size, entries in pulleys.items()
    }

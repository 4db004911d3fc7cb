"""Names that a user chose, as names of variables in netCDF files, and back.

A size ``a/b`` makes a parameter ``omega[a/b]``; in a file a slash parts groups, so that it
stands there as ``%2F``, and so does what else a file could not hold. A file's own variables keep
their names: a covariate that is called as one of these is written otherwise.
"""

import hashlib
import json
import re
import unicodedata
from collections.abc import Collection, Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

_CODE = re.compile(r"%([0-9A-F]{2})")
_LONGEST = 200  # bytes of a name; netCDF holds 256
_SHOWN = 40  # characters of a name that stands in for a longer one
RESIDUALS = frozenset(
    "row rig trial friction_n measured_n calibrated_n diagnosed_n residual_n residual_after_n "
    "noise_sd_n".split()
)
"""What the group ``residuals`` of ``diagnosis.nc`` has beside covariates."""
NAMES = "names_as_written"
"""Attribute of a group: its variables with another name than they were given, as JSON."""
FURTHER = "further_attributes"
"""Attribute of a group: those whose names netCDF cannot hold, as JSON."""


def variable_of(name: str, taken: Collection[str] = ()) -> str:
    """Return the variable's name that stands for a user's name, and for no other.

    Parameters
    ----------
    name : str
        Of a parameter or a covariate.
    taken : collection of str
        Names that the file has for variables of its own.
    """
    code = _CODE.sub(r"%25\1", name).replace("/", "%2F")
    return f"%{ord(code[0]):02X}{code[1:]}" if code in taken and code[0].isascii() else code


def name_of(variable: str) -> str:
    """Return the user's name from which :func:`variable_of` made a variable's."""
    return _CODE.sub(lambda code: chr(int(code[1], 16)), variable)


def by_parameter(posterior: xr.Dataset) -> dict[str, NDArray[np.float64]]:
    """Return stored draws by the user's name of the parameter, each of shape (S,).

    Parameters
    ----------
    posterior : Dataset
        The group of ``draws.nc``, its chains as :func:`bayesfric.chains.by_walker` has them.
    """
    draws = {}
    for name, variable in posterior.data_vars.items():
        if "pulley" in variable.dims:
            for size in posterior["pulley"].to_numpy():
                draws[f"{name}[{size}]"] = variable.sel(pulley=size).to_numpy().ravel()
        else:
            draws[name_of(str(name))] = variable.to_numpy().ravel()
    return draws


def tree_of(groups: Mapping[str, xr.Dataset]) -> xr.DataTree:
    """Return a tree of tables, whose variables are called by :func:`variable_of`.

    Parameters
    ----------
    groups : mapping of str to Dataset
        By the path of the group; variables by the names that users gave them.
    """
    return xr.DataTree.from_dict(
        {
            path: table.rename({name: variable_of(str(name)) for name in table.data_vars})
            for path, table in groups.items()
        }
    )


def storable(tree: xr.DataTree) -> xr.DataTree:
    """Return a tree whose names netCDF can hold; :func:`restored` gives them back.

    Names that are too long in bytes, or that netCDF would write in other characters which look
    alike, are stood in for.
    """
    groups = {}
    for node in tree.subtree:
        table = node.to_dataset(inherit=False)
        others = {name: _stand_in(str(name)) for name in table.data_vars if not _fits(str(name))}
        if others:
            table = table.rename(others)
            written = {short: str(name) for name, short in others.items()}
            table.attrs[NAMES] = json.dumps(written, ensure_ascii=False)
        further = {name: value for name, value in table.attrs.items() if not _fits(str(name))}
        if further:
            table.attrs = {name: v for name, v in table.attrs.items() if name not in further}
            table.attrs[FURTHER] = json.dumps(further, ensure_ascii=False)
        groups[node.path] = table
    return xr.DataTree.from_dict(groups)


def restored(tree: xr.DataTree) -> xr.DataTree:
    """Return a tree that was read, with the names that :func:`storable` was given."""
    groups = {}
    for node in tree.subtree:
        table = node.to_dataset(inherit=False)
        table = table.rename(_of_attribute(table.attrs, NAMES))
        further = _of_attribute(table.attrs, FURTHER)
        table.attrs = {n: v for n, v in table.attrs.items() if n not in (NAMES, FURTHER)} | further
        groups[node.path] = table
    return xr.DataTree.from_dict(groups)


def _of_attribute(attributes: Mapping[Any, Any], name: str) -> dict[str, Any]:
    names: dict[str, Any] = json.loads(attributes.get(name, "{}"))
    return names


def _fits(name: str) -> bool:
    if "/" in name or not (name[:1] == "_" or name[:1].isalnum()):
        return False
    same = name == unicodedata.normalize("NFC", name).strip()
    return same and len(name.encode("utf-8", "replace")) <= _LONGEST


def _stand_in(name: str) -> str:
    shown = unicodedata.normalize("NFC", name)[:_SHOWN].strip()
    return f"_{shown}~{hashlib.sha256(name.encode()).hexdigest()[:8]}"

"""Shipped values of the simulator, and which of them are fixed."""

from collections.abc import Collection, Mapping
from pathlib import Path

import numpy as np

from bayesfric.errors import Fault, InputError
from bayesfric.observation.coefficients import coefficient_name
from bayesfric.physics.friction import Coefficients
from bayesfric.results import read_json, refuse_mixed
from bayesfric.rigs.data import Data
from bayesfric.rigs.truth import table1_coefficients
from bayesfric.schemas import FitFile

Shipped = Mapping[str, Coefficients] | Mapping[str, float]
"""Laws by pulley size, or numbers by name as ``fit.json`` has them."""


def shipped_of(given: Shipped | None, data: Data) -> dict[str, Coefficients]:
    """Return the shipped law of each size; by default from Table I or the machine's model.

    Parameters
    ----------
    given : mapping or None
        Laws by pulley size, or numbers of laws by name; a size without all its numbers has no
        law. If it is None, a joint has the values of its machine's model.
    data : Data
        The rigs, which define the names of their numbers.
    """
    if given is None:
        given = _of_model(data)
    if given is None:
        return table1_coefficients()
    laws = {size: law for size, law in given.items() if isinstance(law, Coefficients)}
    numbers = {
        name: number for name, number in given.items() if not isinstance(number, Coefficients)
    }
    for size in data.sizes:
        names = [name for name, _ in data.law_numbers(size)]
        if any(name in numbers for name in names):
            values = [numbers.get(name, 0.0) for name in names]
            laws[size] = Coefficients(*values, *[0.0] * (len(Coefficients._fields) - len(values)))
    return laws


def _of_model(data: Data) -> dict[str, float] | None:
    """Return the numbers of a joint from its machine's model; None without a model."""
    own = data.rigs[0].in_simulator
    if len(data.rigs) > 1 or not own:
        return None
    # The other forces of the model are subtracted, so the law's mass is the armature alone.
    return {**own, "mass": own.get("armature", 0.0)}


def shipped_numbers(laws: Mapping[str, Coefficients], data: Data) -> dict[str, float]:
    """Return the numbers of shipped laws by the rigs' names."""
    return {
        name: float(np.asarray(value))
        for size in data.sizes
        if size in laws
        for (name, _), value in zip(data.law_numbers(size), laws[size], strict=False)
    }


def held_of(
    fixed: Collection[str], data: Data, shipped: Mapping[str, Coefficients]
) -> frozenset[str]:
    """Return the fixed coefficients, ``c1`` or ``c1[small]``, from the user's names.

    Parameters
    ----------
    fixed : collection of str
        Coefficients of one or all sizes, or a rig's own names of its numbers.
    data : Data
        The rigs.
    shipped : mapping of str to Coefficients
        Values at which they are fixed.

    Raises
    ------
    InputError
        A name is unknown, or has no shipped value.
    """
    sizes_by_name = {name: list(data.sizes) for name in Coefficients._fields}
    stands = {name: name for name in sizes_by_name}
    for size in data.sizes:
        called = data.law_numbers(size)
        for place, field in enumerate(Coefficients._fields):
            own = coefficient_name(field, size)
            for name in {own, *(part[0] for part in called[place : place + 1])}:
                sizes_by_name[name], stands[name] = [size], own
    faults = [
        Fault(
            "command line",
            f"one of {', '.join(sorted(sizes_by_name))}",
            column="--fixed",
            value=name,
        )
        for name in fixed
        if name not in sizes_by_name
    ]
    faults += [
        Fault("command line", f"a shipped value of size {size}", column="--fixed", value=name)
        for name in fixed
        for size in sizes_by_name.get(name, ())
        if size not in shipped
    ]
    if faults:
        raise InputError(faults)
    return frozenset(stands[name] for name in fixed)


def held_values(
    held: Collection[str], data: Data, shipped: Mapping[str, Coefficients]
) -> dict[str, float]:
    """Return the values at which numbers are fixed, by the rigs' names.

    Parameters
    ----------
    held : collection of str
        From :func:`held_of`.
    data, shipped
        As for :func:`held_of`.
    """
    return {
        name: float(np.asarray(value))
        for size in data.sizes
        if size in shipped
        for (name, _), field, value in zip(
            data.law_numbers(size), Coefficients._fields, shipped[size], strict=False
        )
        if {field, coefficient_name(field, size)} & set(held)
    }


def fitted_numbers(folder: Path) -> dict[str, float]:
    """Return the posterior means of a stored fit, by name: ``c1[small]``, ``mass``.

    Parameters
    ----------
    folder : Path
        Where ``fit.json`` is.

    Raises
    ------
    InputError
        There is no fit, or its files are of two runs.
    """
    if folder.is_file():
        raise InputError([Fault(str(folder), "the folder of a fit; this is a file in it")])
    fit = read_json(FitFile, folder / "fit.json")
    refuse_mixed(fit, folder / "fit.json")
    means = {name: entry.mean for name, entry in fit.parameters.items()}
    for size, entries in fit.pulleys.items():
        means |= {coefficient_name(name, size): entry.mean for name, entry in entries.items()}
    return means

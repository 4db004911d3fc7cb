"""The simulator's values as it was shipped, and which of them are held."""

from collections.abc import Collection, Mapping

import numpy as np

from bayesfric.errors import Fault, InputError
from bayesfric.observation.coefficients import coefficient_name
from bayesfric.physics.friction import Coefficients
from bayesfric.rigs.data import Data
from bayesfric.rigs.truth import table1_coefficients

Shipped = Mapping[str, Coefficients] | Mapping[str, float]
"""Laws by pulley size, or numbers by name as ``fit.json`` has them."""


def shipped_of(given: Shipped | None, data: Data) -> dict[str, Coefficients]:
    """Return the shipped law of each size; where nobody says, of Table I or of the model.

    Parameters
    ----------
    given : mapping or None
        Laws by pulley size, or numbers of laws by their names; sizes of which a number lacks
        have no law. Where it is None, a joint has the values of its machine's model.
    data : Data
        The rigs, which know what their numbers are called.
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
    """Return the numbers of a joint as its machine's model has them; None without a model."""
    own = data.rigs[0].in_simulator
    if len(data.rigs) > 1 or not own:
        return None
    # What the model has besides is taken off the force: the law's mass is the armature.
    return {**own, "mass": own.get("armature", 0.0)}


def shipped_numbers(laws: Mapping[str, Coefficients], data: Data) -> dict[str, float]:
    """Return shipped laws as numbers by the names that the rigs have for them."""
    return {
        name: float(np.asarray(value))
        for size in data.sizes
        if size in laws
        for (name, _), value in zip(data.law_numbers(size), laws[size], strict=False)
    }


def held_of(
    fixed: Collection[str], data: Data, shipped: Mapping[str, Coefficients]
) -> frozenset[str]:
    """Return the coefficients that are held, ``c1`` or ``c1[small]``, from what a user wrote.

    Parameters
    ----------
    fixed : collection of str
        Coefficients, of a size or of all, or a rig's own names of its numbers.
    data : Data
        The rigs.
    shipped : mapping of str to Coefficients
        Where they are held.

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
    """Return the values at which numbers are held, by the names that the rigs have for them.

    Parameters
    ----------
    held : collection of str
        As of :func:`held_of`.
    data, shipped
        As of there.
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

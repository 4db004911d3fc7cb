"""``LOOP.toml``, or a bundled loop by its name, to a loop."""

from pathlib import Path

from pydantic import ValidationError

from bayesfric.errors import Fault, InputError, one_of
from bayesfric.files import key_faults, read_toml
from bayesfric.margins.loop_file import Loop
from bayesfric.margins.loop_units import loop_in_other_units
from bayesfric.margins.quantities import FAMILIES
from bayesfric.resources import bundled_loops

TAGS = FAMILIES | {"revolute", "prismatic"}


def loop_path(given: Path) -> Path:
    """Return a loop file that a user names: one that is there, or a bundled one by its name.

    Raises
    ------
    InputError
        It is neither.
    """
    bundled = bundled_loops()
    # a folder of results may well have the name of its loop
    if given.is_file() or (given.exists() and str(given) not in bundled):
        return given
    if str(given) not in bundled:
        expected = f"a loop file that is there, or {one_of(bundled, str(given))}"
        raise InputError([Fault(str(given), expected)])
    return bundled[str(given)]


def read_loop(path: Path) -> Loop:
    """Read and validate a loop file.

    Parameters
    ----------
    path : Path
        The TOML file, or the name of a bundled loop.

    Raises
    ------
    InputError
        With every fault of the file: where, what was found, what was expected.
    """
    path = loop_path(path)
    values = read_toml(path)
    try:
        loop = Loop.model_validate(values)
    except ValidationError as error:
        raise InputError(key_faults(path.name, error, "docs/loop.md", Loop, TAGS)) from error
    if faults := loop_in_other_units(path.name, loop):
        raise InputError(faults)
    return loop

"""The seam between rigs and everything that is inferred from them, a folder a rig.

A folder here whose package holds a ``RIG`` is a rig; there is no list to add it to.
"""

from functools import cache
from importlib import import_module
from pkgutil import iter_modules

from bayesfric.rigs.base import Rig

__all__ = ["Rig", "all_rigs", "paper_rigs"]


@cache
def all_rigs() -> dict[str, Rig]:
    """Return the rigs by name and sorted so."""
    folders = [module.name for module in iter_modules(__path__) if module.ispkg]
    modules = (import_module(f"{__name__}.{name}") for name in folders)
    rigs: list[Rig] = [module.RIG for module in modules if hasattr(module, "RIG")]
    return {rig.name: rig for rig in sorted(rigs, key=lambda rig: rig.name)}


def paper_rigs() -> dict[str, Rig]:
    """Return the paper's own rigs, for which its protocols are laid out."""
    return {name: rig for name, rig in all_rigs().items() if rig.words.paper}

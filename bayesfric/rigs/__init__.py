"""The rigs, each in a folder with its data, likelihood and simulator.

Every subpackage that defines ``RIG`` is a rig and is found automatically.
"""

from functools import cache
from importlib import import_module
from pkgutil import iter_modules

from bayesfric.rigs.base import Rig

__all__ = ["Rig", "all_rigs", "paper_rigs"]


@cache
def all_rigs() -> dict[str, Rig]:
    """Return the rigs by name, in alphabetical order."""
    folders = [module.name for module in iter_modules(__path__) if module.ispkg]
    modules = (import_module(f"{__name__}.{name}") for name in folders)
    rigs: list[Rig] = [module.RIG for module in modules if hasattr(module, "RIG")]
    return {rig.name: rig for rig in sorted(rigs, key=lambda rig: rig.name)}


def paper_rigs() -> dict[str, Rig]:
    """Return the rigs of the paper, which its protocols simulate."""
    return {name: rig for name, rig in all_rigs().items() if rig.words.paper}

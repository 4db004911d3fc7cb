"""The paper's claims, one a file: each compared with rivals, and judged by stated rules.

A file of this folder that holds a ``CLAIM`` is a claim; there is no list to add it to.
"""

from functools import cache
from importlib import import_module
from pkgutil import iter_modules

from bayesfric.claims.base import Claim

__all__ = ["all_claims"]


@cache
def all_claims() -> tuple[Claim, ...]:
    """Return the claims of this folder, in the order of the report."""
    modules = (import_module(f"{__name__}.{found.name}") for found in iter_modules(__path__))
    claims = [module.CLAIM for module in modules if hasattr(module, "CLAIM")]
    return tuple(sorted(claims, key=lambda claim: claim.place))

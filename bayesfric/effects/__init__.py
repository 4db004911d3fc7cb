"""Unmodelled effects, one a file: what the baseline may leave out.

A file of this folder that holds an ``EFFECT`` is an effect; there is no list to add
it to.
"""

from functools import cache
from importlib import import_module
from pkgutil import iter_modules

from bayesfric.effects.base import ActsOn, Effect, EffectParameter, Law, Reading, State

__all__ = ["ActsOn", "Effect", "EffectParameter", "Law", "Reading", "State", "all_effects"]


@cache
def all_effects() -> dict[str, Effect]:
    """Return the effects of this folder, name to effect, sorted by name."""
    modules = (import_module(f"{__name__}.{found.name}") for found in iter_modules(__path__))
    effects = [module.EFFECT for module in modules if hasattr(module, "EFFECT")]
    return {effect.name: effect for effect in sorted(effects, key=lambda effect: effect.name)}

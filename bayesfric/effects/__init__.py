"""Effects that the baseline may leave out, one in each file.

Every file of this folder that defines ``EFFECT`` is an effect; there is no list to add it
to. Other packages add effects by the entry point ``bayesfric.effects``. A user's own file
is read by :func:`effect_of_file`.
"""

from collections.abc import Mapping
from dataclasses import replace
from difflib import get_close_matches
from functools import cache
from importlib import import_module
from importlib.metadata import entry_points
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from pkgutil import iter_modules

from bayesfric.analysis import Prior
from bayesfric.effects.base import ActsOn, Effect, EffectParameter, Law, Reading, State
from bayesfric.errors import Fault, InputError, one_of

__all__ = [
    "NO_OFFSET",
    "PULLEYS",
    "ActsOn",
    "Effect",
    "EffectParameter",
    "Law",
    "Reading",
    "State",
    "all_effects",
    "effect_of_file",
    "with_priors",
]


PULLEYS = frozenset({"pulleys", "turns"})
"""What boards with pulleys offer: pulleys, and motion that starts anew, as after a reversal."""
NO_OFFSET = "law-without-offset"
"""What a rig offers if its law has no constant force, so that such a force may be an effect."""


@cache
def all_effects(offered: frozenset[str] | None = PULLEYS) -> dict[str, Effect]:
    """Return the effects of this folder and of other packages, sorted by name.

    Parameters
    ----------
    offered : frozenset of str or None
        What a rig offers; effects that need more are left out. The default is that of a
        cable over pulleys. None keeps all effects.
    """
    modules = (import_module(f"{__name__}.{module.name}") for module in iter_modules(__path__))
    effects = [module.EFFECT for module in modules if hasattr(module, "EFFECT")]
    effects += [entry_point.load() for entry_point in entry_points(group="bayesfric.effects")]
    ordered = sorted(effects, key=lambda effect: effect.name)
    return {effect.name: effect for effect in ordered if offered is None or effect.needs <= offered}


def effect_of_file(path: Path) -> Effect:
    """Return the effect that a user's Python file defines as ``EFFECT``.

    Parameters
    ----------
    path : Path
        The file. It is executed.

    Raises
    ------
    InputError
        There is no such file, it does not run, or it has no ``EFFECT``.
    """
    expected = "a Python file that defines EFFECT, a bayesfric.effects.Effect"
    spec = spec_from_file_location(path.stem, path) if path.is_file() else None
    if spec is None or spec.loader is None:
        raise InputError([Fault(str(path), expected)])
    module = module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except Exception as error:  # any error of a user's file is reported with its place
        raise InputError([Fault(str(path), f"{expected} ({error!r})")]) from error
    effect = getattr(module, "EFFECT", None)
    if not isinstance(effect, Effect):
        raise InputError([Fault(str(path), expected)])
    return effect


def with_priors(
    effects: Mapping[str, Effect], priors: Mapping[str, Mapping[str, Prior]]
) -> dict[str, Effect]:
    """Return effects with their priors replaced by those of an analysis.

    Parameters
    ----------
    effects : mapping of str to Effect
        The effects by name.
    priors : mapping of str to mapping of str to Prior
        Priors by the names of an effect and of one of its parameters.

    Returns
    -------
    dict of str to Effect
        All of `effects`. Priors of effects that are not among them, such as those of another
        rig, are ignored.

    Raises
    ------
    InputError
        There is no such effect on any rig, or it has no such parameter.
    """
    faults, changed = [], dict(effects)
    anywhere = all_effects(None) | changed
    for name, own in priors.items():
        if name not in anywhere:
            nearest = get_close_matches(name.casefold(), list(anywhere), n=3, cutoff=0.0)
            expected = f"an effect that `bayesfric effects` lists, such as {', '.join(nearest)}"
            faults.append(Fault("priors.effects", expected, value=name))
            continue
        effect = anywhere[name]
        names = [parameter.name for parameter in effect.parameters]
        faults += [
            Fault(f"priors.effects.{name}", one_of(names, wrong), value=wrong)
            for wrong in own
            if wrong not in names
        ]
        amplitude, shape = (
            None
            if parameter is None
            else replace(parameter, prior=own.get(parameter.name, parameter.prior))
            for parameter in (effect.amplitude, effect.shape)
        )
        assert amplitude is not None
        if name in effects:
            changed[name] = replace(effect, amplitude=amplitude, shape=shape)
    if faults:
        raise InputError(faults)
    return changed

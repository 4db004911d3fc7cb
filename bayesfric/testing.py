"""Checks of an effect, for its author: run them on a file of your own before you use it."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy import integrate

from bayesfric.effects import Effect, State
from bayesfric.errors import Fault, InputError
from bayesfric.friction import Coefficients
from bayesfric.priors import from_normal, log_density

__all__ = ["EffectError", "check_effect", "checked"]

Array = NDArray[np.float64]
UNITS = {
    "1",
    "N",
    "A",
    "m",
    "s",
    "kg",
    "s/m",
    "m/s",
    "1/m",
    "1/s",
    "1/N",
    "1/deg",
    "s²/m²",
    "N s/m",
}
SEEN = 8.0  # prior standard deviations to either side, beyond which nothing is left
SPEEDS_M_S = np.geomspace(0.01, 1.3, 12)


class EffectError(ValueError):
    """An effect breaks a rule; the message says which, where, and by how much."""


def check_effect(effect: Effect) -> None:
    """Check that an effect is one that the likelihood and the evidence can use.

    Parameters
    ----------
    effect : Effect
        To be checked: priors integrate to one; the plausible range lies where the prior
        is; units are known; no amplitude is no effect; forces are finite; and an effect
        along a path is linear in its amplitude.

    Raises
    ------
    EffectError
        At the first rule that is broken.
    """
    for parameter in effect.parameters:
        where = f"{effect.name}.{parameter.name}"
        if parameter.unit not in UNITS:
            raise EffectError(f"{where}: the unit {parameter.unit!r} is none of {sorted(UNITS)}")
        low, high = (float(from_normal(parameter.prior, end)) for end in (-SEEN, SEEN))
        middle = float(from_normal(parameter.prior, 0.0))
        mass = integrate.quad(
            lambda x, prior=parameter.prior: float(np.exp(log_density(prior, x))),
            low,
            high,
            points=[middle],
            limit=400,
        )[0]
        if abs(mass - 1) > 1e-6:
            raise EffectError(f"{where}: the prior integrates to {mass:.6f}, not to 1")
        if not (low <= parameter.plausible[1] and parameter.plausible[0] <= high):
            raise EffectError(f"{where}: the plausible range {parameter.plausible} is not in reach")
        if not parameter.reference:
            raise EffectError(f"{where}: the plausible range has no reference")
    if effect.shape is not None and effect.shape.typical is None:
        raise EffectError(f"{effect.name}.{effect.shape.name}: a shape needs a typical value")
    if not effect.laws:
        raise EffectError(f"{effect.name}: there is no law")
    state = State.of(Coefficients(0.01, 0.02, 2e-5), 9.0, 85.0, 15.0, SPEEDS_M_S, 2.0)
    for name in effect.laws:
        _check_law(effect, name, state)


def _check_law(effect: Effect, name: str, state: State) -> None:
    where = f"{effect.name}/{name}"
    if (none := np.abs(_value(effect, name, 0.0, state)).max()) > 0:
        raise EffectError(f"{where}: at no amplitude it still is {none:g}, not 0")
    one = 0.01
    force = _value(effect, name, one, state)
    if not np.isfinite(force).all():
        raise EffectError(f"{where}: not finite at {effect.amplitude.name} = {one}")
    changes = bool(np.ptp(force) > 1e-12 * np.abs(force).max())
    if changes and not effect.along_path and effect.acts_on == "friction":
        raise EffectError(f"{where}: it changes with speed, but is not said to act along_path")
    if effect.along_path:
        off = np.abs(_value(effect, name, 2 * one, state) - 2 * force).max()
        if off > 1e-9 * np.abs(force).max():
            raise EffectError(f"{where}: not linear in {effect.amplitude.name}; off by {off:g}")


def _value(effect: Effect, name: str, amplitude: float, state: State) -> Array:
    values = {effect.amplitude.name: np.array(amplitude)}
    if effect.shape is not None:
        values[effect.shape.name] = np.array(effect.shape.typical)
    found = np.asarray(effect.laws[name](values, state), dtype=np.float64)
    return np.broadcast_to(found, SPEEDS_M_S.shape)


def checked(effect: Effect, path: Path) -> Effect:
    """Return an effect of a user's file once it has passed :func:`check_effect`.

    Raises
    ------
    InputError
        A rule is broken; it names the file and the rule.
    """
    try:
        check_effect(effect)
    except EffectError as error:
        raise InputError([Fault(str(path), str(error))]) from error
    return effect

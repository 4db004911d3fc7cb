"""How strong an effect is: STRENGTH 1 changes friction by 10 % rms over the design.

Over the design: over the trials, at equal steps of time, and the runs, of the boards that
the effect changes at all. What an effect with components changes is the rms over their
phases. Of the other things that effects act on, the equivalent of friction is

- a drive's force itself;
- what one would take for friction in a motor current;
- of a reading e that is off, (m1 + m2) d²e/dt², with e the mean of both sensors along the
  motion of the law: what a parabola through the events takes for acceleration. Where e
  goes to and fro, as magnets off their places make it, no parabola sees much of that; it
  is counted nevertheless, and a strength of 1 is then a small amplitude.
"""

from collections.abc import Callable

import numpy as np
import scipy

from bayesfric.arrays import Array
from bayesfric.effects import Effect, all_effects
from bayesfric.errors import Fault, InputError, one_of
from bayesfric.recording.tables import RigConstants
from bayesfric.rigs import paper_rigs
from bayesfric.rigs.changes import Change
from bayesfric.rigs.own_design import OwnDesign
from bayesfric.rigs.protocols import Protocol
from bayesfric.rigs.truth import AppliedEffect, Truth

RMS_AT_FULL_STRENGTH = 0.1
LARGEST_AMPLITUDE = 1e6


def at_strength(
    name: str,
    strength: float,
    design: Protocol | OwnDesign,
    constants: RigConstants,
    truth: Truth,
    law: str | None = None,
) -> AppliedEffect:
    """Return an effect of a given strength.

    Parameters
    ----------
    name : str
        Of an effect.
    strength : float
        1: friction, or its equivalent, changes by 10 % rms over the trials (at equal
        steps of time) and the runs of the design, before anything is refitted; a
        negative strength has an amplitude below 0.
    design : Protocol or OwnDesign
        The gravity board's trials, or what another rig is simulated with.
    constants : RigConstants
        Of all boards.
    truth : Truth
        The law.
    law : str or None
        Variant; None is the effect's first.

    Returns
    -------
    AppliedEffect
        With its amplitude solved for, and its shape at the typical value.

    Raises
    ------
    InputError
        There is no such effect, or no amplitude is so strong.
    """
    effect = _effect(name, design)
    chosen = next(iter(effect.laws)) if law is None else law
    shape: dict[str, float] = {}
    if effect.shape is not None and effect.shape.typical is not None:
        shape[effect.shape.name] = effect.shape.typical
    sign, wanted = -1.0 if strength < 0 else 1.0, RMS_AT_FULL_STRENGTH * abs(strength)
    changes = _changes(effect, design, constants, truth)

    def applied(amplitude: float) -> AppliedEffect:
        return AppliedEffect(effect, chosen, {effect.amplitude.name: sign * amplitude} | shape)

    def excess(amplitude: float) -> float:
        squares = [_square(effect, change(applied(amplitude))) for change in changes]
        seen = [rows for rows in squares if rows.any()]
        rms = float(np.sqrt(np.concatenate(seen).mean())) if seen else 0.0
        return rms - wanted

    amplitude = 0.0 if strength == 0 else _root(excess)
    if amplitude is None:
        expected = f"a strength that {name} can have"
        raise InputError([Fault("effect", expected, value=f"{strength:g}")])
    return applied(amplitude)


def _effect(name: str, design: Protocol | OwnDesign) -> Effect:
    effects = all_effects(design.offers) if isinstance(design, OwnDesign) else all_effects()
    if name not in effects:
        raise InputError([Fault("effect", one_of(effects, name), value=name)])
    return effects[name]


def _changes(
    effect: Effect, design: Protocol | OwnDesign, constants: RigConstants, truth: Truth
) -> list[Change]:
    """Return, of each rig that the effect changes, what it does to friction there."""
    changes = (
        [design.change(effect, constants, truth)]
        if isinstance(design, OwnDesign)
        else [rig.change(effect, design, constants, truth) for rig in paper_rigs().values()]
    )
    return [change for change in changes if change is not None]


def _root(excess: Callable[[float], float]) -> float | None:
    """Return the amplitude at which nothing is in excess; None where there is none so large."""
    high = 1e-3
    while excess(high) < 0:
        high *= 2
        if high > LARGEST_AMPLITUDE:
            return None
    return float(scipy.optimize.brentq(excess, 0.0, high, xtol=1e-10 * high, rtol=1e-10))


def _square(effect: Effect, change: Array) -> Array:
    """Return the mean square of each row's change over its times and phases."""
    squares = change**2
    if effect.components:
        squares = squares.sum(axis=0)
    return np.asarray(squares.mean(axis=-1))

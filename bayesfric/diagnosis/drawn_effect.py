"""Posterior draws of an effect on friction, to predict friction at other conditions."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from bayesfric.arrays import Array, Whole
from bayesfric.effects.base import Effect, State


@dataclass(frozen=True)
class DrawnEffect:
    """Posterior draws of one effect on friction.

    Parameters
    ----------
    effect : Effect
        The effect.
    amplitude, shape : ndarray, shape (draws,)
        Draws; 0 if it does not act in a draw, or has no shape.
    variant : ndarray of str, shape (draws,)
        Name of its law; empty if it does not act in a draw.
    """

    effect: Effect
    amplitude: Array
    shape: Array
    variant: NDArray[np.str_]

    def taken(self, order: Whole) -> "DrawnEffect":
        """Return the draws with the given indices, in this order."""
        return replace(
            self,
            amplitude=self.amplitude[order],
            shape=self.shape[order],
            variant=self.variant[order],
        )

    def force(self, state: State) -> Array:
        """Return the force that it adds to friction in a state, shape (draws,) [N]."""
        force = np.zeros(self.amplitude.shape)
        for name in np.unique(self.variant[self.variant != ""]):
            mine = self.variant == name
            p = {self.effect.amplitude.name: np.where(mine, self.amplitude, 0.0)}
            if self.effect.shape is not None:
                p[self.effect.shape.name] = np.where(mine, self.shape, 1.0)
            force += np.where(mine, self.effect.laws[str(name)](p, state), 0.0)
        return force


def drawn_effect(table: xr.Dataset, name: str, effects: Mapping[str, Effect]) -> DrawnEffect | str:
    """Return draws of an effect, or why it does not apply to another machine.

    Only effects on friction apply to the same pulleys in another machine.

    Parameters
    ----------
    table : Dataset
        Group ``law`` of ``diagnosis.nc``.
    name : str
        Name of the effect.
    effects : mapping of str to Effect
        All effects by name.
    """
    effect = effects.get(name)
    if effect is None:
        return "not an effect of this version"
    if effect.acts_on != "friction":
        return f"acts on the board's {effect.acts_on}, not friction"
    if effect.components:
        return "its phase differs from trial to trial"
    if "effect" not in table.coords or name not in table["effect"]:
        return "its amplitude was not drawn"
    own = table.sel(effect=name)
    variant = own["variant"].to_numpy().astype(str)
    if unknown := set(variant) - {"", *effect.laws}:
        return f"{', '.join(sorted(unknown))}: not a law of this version"
    amplitude, shape = (own[column].to_numpy().astype(float) for column in ("amplitude", "shape"))
    return DrawnEffect(effect, amplitude, shape, variant)

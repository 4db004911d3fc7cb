"""Play in a transmission: after a reversal the drive turns alone for a while."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from bayesfric.analysis import HalfNormal, LogNormal
from bayesfric.effects.base import Effect, EffectParameter, State

Array = NDArray[np.float64]


def _gap(p: Mapping[str, Array], state: State) -> Array:
    return np.asarray(-p["share"] * state.friction_n * _loose(p, state))


def _gap_with_mass(p: Mapping[str, Array], state: State) -> Array:
    inertia = np.asarray(state.drive_force_n) * np.asarray(state.direction)
    return np.asarray(-p["share"] * inertia * _loose(p, state))


def _loose(p: Mapping[str, Array], state: State) -> Array:
    """Return 1 inside the gap and 0 beyond it, over a tenth of the gap."""
    way = np.asarray(state.travel_m) / p["gap"]
    inside = 0.5 * (1 - np.tanh(10 * (way - 1)))
    return np.asarray(inside * np.abs(np.asarray(state.direction)))


EFFECT = Effect(
    name="backlash",
    acts_on="drive",
    sentence="after a reversal the drive runs through play before it takes the load along",
    amplitude=EffectParameter(
        name="share",
        unit="1",
        meaning="part of the friction, or of the force, that is missing in the gap",
        prior=HalfNormal(scale=0.5),
        plausible=(0.0, 1.0),
        reference="by definition: between nothing and all of it is behind the gap",
    ),
    shape=EffectParameter(
        name="gap",
        unit="m",
        meaning="play",
        prior=LogNormal(median=0.01, sd_log=0.8),
        plausible=(1e-4, 0.06),
        reference="argued: from a thousandth of the travel to a tenth of it, which one would see",
        typical=0.01,
    ),
    laws={"friction": _gap, "force": _gap_with_mass},
    along_path=True,
    needs=frozenset({"direction", "drive"}),
)

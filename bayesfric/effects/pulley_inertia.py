"""Inertia of the pulleys: mass that moves with the cable."""

import numpy as np

from bayesfric.analysis import HalfNormal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State
from bayesfric.effects.state import MEDIUM_RADIUS_M


def _same(p: Parameters, state: State) -> Array:
    per_pulley = p["mass"] * np.asarray(state.acceleration_m_s2) * (not state.steady)
    return np.asarray(per_pulley * np.asarray(state.n_pulleys))


def _discs(p: Parameters, state: State) -> Array:
    # Discs of one thickness: the mass is ∝ radius², and half of it moves with the rim.
    return _same(p, state) * (np.asarray(state.radius_m) / MEDIUM_RADIUS_M) ** 2


EFFECT = Effect(
    name="pulley-inertia",
    acts_on="drive",
    sentence="the pulleys have mass that must be accelerated with the cable",
    amplitude=EffectParameter(
        name="mass",
        unit="kg",
        meaning="moment of inertia of a pulley (of the medium size, where sizes differ) over its "
        "radius squared",
        prior=HalfNormal(scale=0.02),
        plausible=(0.0, 0.01),
        reference="argued: half the mass of a steel disc of the large pulley's radius and 5 mm "
        "is 8 g; pulleys of aluminium, or smaller, have less",
    ),
    laws={"same": _same, "discs": _discs},
    edge={"acceleration_m_s2": 1.2, "n_pulleys": 19.0},
    needs=frozenset({"pulleys"}),
    axes=frozenset({"acceleration"}),
)

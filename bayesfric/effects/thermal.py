"""Friction that changes as the axis warms up: with a logged temperature, or with work done.

Grease thins as it warms. If the temperature only rises, this effect is confounded with
``wear-drift``. For friction points without a temperature the two are identical.
"""

import numpy as np

from bayesfric.analysis import Normal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State


def _warm(p: Parameters, state: State) -> Array:
    return np.asarray(p["change"] * state.friction_n * np.asarray(state.warmth))


EFFECT = Effect(
    name="thermal",
    acts_on="friction",
    sentence="friction changes with temperature, or with the work that has been done",
    amplitude=EffectParameter(
        name="change",
        unit="1",
        meaning="change of friction from the coldest to the warmest of the recording, as a share "
        "of it",
        prior=Normal(mean=0.0, sd=0.3),
        plausible=(-0.8, 0.8),
        reference="argued: grease thins by more than half over 30 °C; that temperature matters as "
        "much as load in a robot's joint is in Bittencourt and Gunnarsson, J. Dyn. Sys., Meas., "
        "Control 134 (2012) 051013",
    ),
    laws={"warmth": _warm},
    along_path=True,
    needs=frozenset({"warmth"}),
    axes=frozenset({"temperature", "time", "order"}),
)

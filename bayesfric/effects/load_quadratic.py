"""Friction that grows with the square of the gear's load: k ℓ².

This is the last step of M6 of Duclusaud et al., in which the square also decays with speed. Over a
small range of loads it is the same as ``load-friction``. The two never act together.
"""

import numpy as np

from bayesfric.analysis import HalfNormal
from bayesfric.arrays import Array
from bayesfric.effects.base import BY_LOAD, LADDER, Effect, EffectParameter, Parameters, State


def _square(p: Parameters, state: State) -> Array:
    return np.asarray(p["rate"] * np.asarray(state.carried_n) ** 2)


def _square_at_rest(p: Parameters, state: State) -> Array:
    return np.asarray(p["rate"] * np.asarray(state.held_n) ** 2)


EFFECT = Effect(
    name="load-quadratic",
    acts_on="drive",
    sentence="friction grows with the square of the load that the gear carries",
    amplitude=EffectParameter(
        name="rate",
        unit="1/N",
        meaning="additional friction per square of the load",
        prior=HalfNormal(scale=0.03),
        plausible=(0.0, 0.1),
        reference=f"{LADDER}: 0.002 to 0.01 for each N·m, of joints whose friction is 0.02 to "
        "6 N·m: up to 0.06 in units of friction",
    ),
    laws={"square": _square, "of-what-is-held": _square_at_rest},
    along_path=True,
    needs=frozenset({"direction", "load-both-ways"}),
    axes=frozenset({"load", "displacement", "acceleration"}),
    ladder=BY_LOAD,
)

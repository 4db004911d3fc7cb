"""A drag that is there whatever the number of pulleys."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from bayesfric.analysis import HalfNormal
from bayesfric.effects.base import Effect, EffectParameter, State

Array = NDArray[np.float64]


def _constant(p: Mapping[str, Array], state: State) -> Array:
    return p["drag"] * np.ones_like(np.asarray(state.n_pulleys, dtype=np.float64))


EFFECT = Effect(
    name="fixed-drag",
    acts_on="friction",
    sentence="a constant force opposes the motion, whatever the number of pulleys",
    amplitude=EffectParameter(
        name="drag",
        unit="N",
        meaning="force against the motion",
        prior=HalfNormal(scale=0.1),
        plausible=(0.0, 0.1),
        reference="argued: two sensor pulleys of the medium size at 5 N, by Table I 2 (c1 T + c2)"
        " = 0.07 N",
    ),
    laws={"constant": _constant},
    edge={"n_pulleys": 5.0},
)

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
        reference="two sensor pulleys of the medium size at low tension: Table I gives 2 c2 = "
        "0.03 N and c1 T as much again at 5 N",
    ),
    laws={"constant": _constant},
    edge={"n_pulleys": 5.0},
)

"""Friction that is not proportional to the number of pulleys."""

import numpy as np

from bayesfric.analysis import Normal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State

MIDDLE_COUNT = 9.0


def _power(p: Parameters, state: State) -> Array:
    ratio = np.asarray(state.n_pulleys, dtype=np.float64) / MIDDLE_COUNT
    return state.friction_n * np.expm1(p["exponent"] * np.log(ratio))


EFFECT = Effect(
    name="pulley-count-curvature",
    acts_on="friction",
    sentence="friction is proportional to a power of the number of pulleys, with an exponent "
    "that is not 1",
    amplitude=EffectParameter(
        name="exponent",
        unit="1",
        meaning="k of friction that is proportional to n (n/9)ᵏ, for n pulleys",
        prior=Normal(mean=0.0, sd=0.2),
        plausible=(-0.1, 0.1),
        reference="argued: the pulley-by-pulley form of eq. (15) departs from it by less than 1 %"
        " over 5 to 19 pulleys; ten times that is left for alignment",
    ),
    laws={"power": _power},
    edge={"n_pulleys": 19.0},
    needs=frozenset({"pulleys"}),
    axes=frozenset({"n_pulleys"}),
)

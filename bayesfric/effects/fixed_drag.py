"""A drag that does not depend on the number of pulleys."""

import numpy as np

from bayesfric.analysis import HalfNormal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State
from bayesfric.effects.state import REFERENCE_TENSION_N

WITH_TENSION = 0.4  # share at 15 N that grows with tension; 0.8 for a pulley by Table I, 0 for felt


def _constant(p: Parameters, state: State) -> Array:
    return p["drag"] * np.ones_like(np.asarray(state.n_pulleys, dtype=np.float64))


def _with_tension(p: Parameters, state: State) -> Array:
    # The drag of sensor pulleys grows with tension; that of felt and brushes does not.
    more = np.asarray(state.tension_n) / REFERENCE_TENSION_N - 1
    return np.asarray(_constant(p, state) * (1 + WITH_TENSION * more))


EFFECT = Effect(
    name="fixed-drag",
    acts_on="friction",
    sentence="a force opposes the motion, whatever the number of pulleys",
    amplitude=EffectParameter(
        name="drag",
        unit="N",
        meaning="force against the motion",
        prior=HalfNormal(scale=0.1),
        plausible=(0.0, 0.1),
        reference="argued: two sensor pulleys of the medium size at 5 N, by Table I 2 (c1 T + c2)"
        " = 0.07 N",
    ),
    laws={"constant": _constant, "with-tension": _with_tension},
    edge={"n_pulleys": 5.0},
    needs=frozenset({"pulleys"}),
    axes=frozenset({"n_pulleys"}),
)

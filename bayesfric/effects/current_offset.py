"""A current sensor whose zero moved between the idle motor and the runs."""

import numpy as np

from bayesfric.analysis import Normal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State


def _constant(p: Parameters, state: State) -> Array:
    return p["offset"] * np.ones_like(np.asarray(state.load_current_a, dtype=np.float64))


EFFECT = Effect(
    name="current-offset",
    acts_on="current",
    sentence="the zero of the current sensor moved between the idle motor and the runs",
    amplitude=EffectParameter(
        name="offset",
        unit="A",
        meaning="constant that is added to the current of the runs alone",
        prior=Normal(mean=0.0, sd=0.05),
        plausible=(-0.05, 0.05),
        reference="argued: the zero of a current sensor for ten amperes is good to half a per "
        "cent of its range",
    ),
    laws={"constant": _constant},
    needs=frozenset({"pulleys"}),
    axes=frozenset({"n_pulleys", "rig"}),
)

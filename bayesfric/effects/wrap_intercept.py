"""An angle term that does not scale with tension: c2 changes with the wrap angle."""

import numpy as np

from bayesfric.analysis import Normal
from bayesfric.arrays import Array
from bayesfric.effects.base import WRAP_SPAN_DEG, Effect, EffectParameter, Parameters, State
from bayesfric.physics.friction import REFERENCE_WRAP_ANGLE_DEG


def _linear(p: Parameters, state: State) -> Array:
    turn = (np.asarray(state.wrap_angle_deg) - REFERENCE_WRAP_ANGLE_DEG) / WRAP_SPAN_DEG
    scale = np.asarray(state.n_pulleys) * np.asarray(state.pulley_friction_n)
    return np.asarray(p["slope"] * scale * turn)


EFFECT = Effect(
    name="wrap-intercept",
    acts_on="friction",
    sentence="friction at zero tension changes with the wrap angle",
    amplitude=EffectParameter(
        name="slope",
        unit="1",
        meaning="change of friction at 50° from 85°, the same at every tension, as a share of "
        "the friction of a pulley at 15 N and 85°",
        prior=Normal(mean=0.0, sd=0.2),
        plausible=(-0.15, 0.15),
        reference="argued: bending a cable on and off a pulley takes a force that hardly grows "
        "with tension, and is smaller than the friction of a loaded pulley (on rope "
        "bending, Feyrer, Wire Ropes, 2015)",
    ),
    laws={"linear": _linear},
    edge={"wrap_angle_deg": 150.0},
    needs=frozenset({"pulleys"}),
    axes=frozenset({"tension", "wrap_angle"}),
)

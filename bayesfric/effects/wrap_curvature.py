"""Friction that is not linear in the wrap angle."""

import numpy as np

from bayesfric.analysis import Normal
from bayesfric.arrays import Array
from bayesfric.effects.base import WRAP_SPAN_DEG, Effect, EffectParameter, Parameters, State
from bayesfric.physics.friction import REFERENCE_WRAP_ANGLE_DEG


def _quadratic(p: Parameters, state: State) -> Array:
    bend = ((np.asarray(state.wrap_angle_deg) - REFERENCE_WRAP_ANGLE_DEG) / WRAP_SPAN_DEG) ** 2
    return np.asarray(p["curvature"] * np.asarray(state.tension_friction_n) * bend)


EFFECT = Effect(
    name="wrap-curvature",
    acts_on="friction",
    sentence="friction is not a straight line in the wrap angle",
    amplitude=EffectParameter(
        name="curvature",
        unit="1",
        meaning="relative deviation of friction/tension from the straight line, at 50° from 85°",
        prior=Normal(mean=0.0, sd=0.2),
        plausible=(-0.15, 0.15),
        reference="argued: the bearing load 2T sin(θ/2) deviates from a line by a tenth of itself "
        "over ±50°, and belt friction exp(μθ) by less",
    ),
    laws={"quadratic": _quadratic},
    edge={"wrap_angle_deg": 150.0},
    needs=frozenset({"pulleys"}),
    axes=frozenset({"wrap_angle"}),
)

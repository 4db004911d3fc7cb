"""Runout: friction that varies once a revolution of the pulleys."""

import numpy as np

from bayesfric.analysis import HalfNormal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State


def _once(p: Parameters, state: State) -> Array:
    angle = np.asarray(state.travel_m) / np.asarray(state.radius_m)
    force = p["share"] * state.friction_n * (not state.steady)
    return np.stack([force * np.cos(angle), force * np.sin(angle)])


EFFECT = Effect(
    name="runout",
    acts_on="friction",
    sentence="friction varies once per revolution of the pulleys",
    amplitude=EffectParameter(
        name="share",
        unit="1",
        meaning="rms of the variation, as a share of friction",
        prior=HalfNormal(scale=0.2),
        plausible=(0.0, 0.2),
        reference="argued: a pulley with a runout of a tenth of its radius changes its friction "
        "by a tenth; several pulleys in step at most double that",
    ),
    laws={"once": _once},
    along_path=True,
    components=2,
    needs=frozenset({"pulleys"}),
    axes=frozenset({"rotation_angle"}),
)

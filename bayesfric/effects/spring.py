"""A spring, a hose or a cable that pulls an axis back to one place."""

import numpy as np

from bayesfric.analysis import HalfNormal, Normal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State


def _linear(p: Parameters, state: State) -> Array:
    stretch = np.asarray(state.position_m) - p["rest"]
    return np.asarray(p["stiffness"] * stretch * np.asarray(state.direction))


EFFECT = Effect(
    name="spring",
    acts_on="drive",
    sentence="a spring pulls the axis back to one place",
    amplitude=EffectParameter(
        name="stiffness",
        unit="N/m",
        meaning="force for each unit of travel",
        prior=HalfNormal(scale=3.0),
        plausible=(0.0, 30.0),
        reference="argued: hoses and cables that drag along pull with up to several times the "
        "friction at the end of travel",
    ),
    shape=EffectParameter(
        name="rest",
        unit="m",
        meaning="position at which the spring exerts no force",
        prior=Normal(mean=0.0, sd=0.15),
        plausible=(-0.6, 0.6),
        reference="argued: somewhere within the travel, whose zero is near its middle or at an end",
        typical=0.05,
    ),
    laws={"linear": _linear},
    along_path=True,
    needs=frozenset({"position", "direction"}),
    axes=frozenset({"direction", "displacement"}),
)

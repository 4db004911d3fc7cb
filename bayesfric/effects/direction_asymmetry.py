"""Friction that differs between the two directions of an axis."""

import numpy as np

from bayesfric.analysis import Normal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State


def _relative(p: Parameters, state: State) -> Array:
    return np.asarray(p["share"] * state.friction_n * np.asarray(state.direction))


EFFECT = Effect(
    name="direction-asymmetry",
    acts_on="friction",
    sentence="friction differs between the two directions",
    amplitude=EffectParameter(
        name="share",
        unit="1",
        meaning="friction in the positive direction beyond the mean of both, as a share of it",
        prior=Normal(mean=0.0, sd=0.3),
        plausible=(-0.5, 0.5),
        reference="argued: gears and seals that are not symmetric differ by tens of per cent "
        "between directions; a factor of three would be a fault",
    ),
    laws={"relative": _relative},
    along_path=True,
    needs=frozenset({"direction"}),
    axes=frozenset({"direction"}),
)

"""A constant force along an axis: tilt, a weight, an offset of the drive."""

import numpy as np

from bayesfric.analysis import Normal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State


def _constant(p: Parameters, state: State) -> Array:
    return np.asarray(p["force"] * np.asarray(state.direction))


EFFECT = Effect(
    name="axis-bias",
    acts_on="drive",
    sentence="a constant force pushes against the positive direction, as tilt or an offset would",
    amplitude=EffectParameter(
        name="force",
        unit="N",
        meaning="force against the positive direction",
        prior=Normal(mean=0.0, sd=0.5),
        plausible=(-3.0, 3.0),
        reference="argued: a tilt of a few degrees, or the offset of an amplifier, pushes an axis "
        "with less than several times its friction",
    ),
    laws={"constant": _constant},
    along_path=True,
    needs=frozenset({"direction", "law-without-offset"}),
    axes=frozenset({"direction"}),
)

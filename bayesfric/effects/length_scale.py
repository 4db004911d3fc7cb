"""A mean spacing of the magnets that is not the specified one."""

import numpy as np

from bayesfric.analysis import Normal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, Reading


def _proportional(p: Parameters, reading: Reading) -> Array:
    return np.asarray(p["excess"] * np.asarray(reading.displacement_m))


EFFECT = Effect(
    name="length-scale",
    acts_on="reading",
    sentence="the mean travel between two events is not the specified one",
    amplitude=EffectParameter(
        name="excess",
        unit="1",
        meaning="relative error of the travel between two events, positive where it is longer",
        prior=Normal(mean=0.0, sd=0.02),
        plausible=(-0.02, 0.02),
        reference="argued: the radius at the cable's centre, 7.8 mm, is known to a tenth of a "
        "millimetre or so",
    ),
    laws={"proportional": _proportional},
    along_path=True,
    needs=frozenset({"pulleys"}),
    axes=frozenset({"acceleration"}),
)

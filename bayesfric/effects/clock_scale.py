"""A clock whose rate is not the specified one.

To first order it equals an error of the length scale that is twice as large: from rest, v t is
twice the travel. On the gravity board the two cannot be told apart.
"""

import numpy as np

from bayesfric.analysis import Normal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, Reading


def _proportional(p: Parameters, reading: Reading) -> Array:
    # If the clock reads too long by ε t, the cable is v ε t further on at the recorded time.
    return np.asarray(p["excess"] * np.asarray(reading.speed_m_s) * np.asarray(reading.time_s))


EFFECT = Effect(
    name="clock-scale",
    acts_on="reading",
    sentence="the clock's rate is not the specified one",
    amplitude=EffectParameter(
        name="excess",
        unit="1",
        meaning="relative error of the times, positive where they read too long",
        prior=Normal(mean=0.0, sd=0.01),
        plausible=(-0.005, 0.005),
        reference="argued: ceramic resonators, as on small controller boards, are good to half "
        "a per cent, quartz to far less",
    ),
    laws={"proportional": _proportional},
    along_path=True,
    needs=frozenset({"pulleys"}),
    axes=frozenset({"acceleration"}),
)

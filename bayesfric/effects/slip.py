"""Cable that slips: the two sensors disagree ever more."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from bayesfric.analysis import Normal
from bayesfric.effects.base import Effect, EffectParameter, Reading

Array = NDArray[np.float64]


def _proportional(p: Mapping[str, Array], reading: Reading) -> Array:
    at_load = np.asarray(reading.displacement_m) * np.asarray(reading.is_load)
    return np.asarray(p["share"] * at_load)


EFFECT = Effect(
    name="slip",
    acts_on="reading",
    sentence="the cable slips, so that the two sensors disagree",
    amplitude=EffectParameter(
        name="share",
        unit="1",
        meaning="travel that the load end's sensor misses, as a share of travel; negative where "
        "the drive end's does",
        prior=Normal(mean=0.0, sd=0.03),
        plausible=(-0.01, 0.01),
        reference="argued: elastic creep over a pulley is the difference of strain, under 33 N / "
        "15 kN = 0.2 %; several times that where the cable slips for moments",
    ),
    laws={"proportional": _proportional},
    along_path=True,
)

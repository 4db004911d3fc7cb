"""A mass on the drive side that is not what was written down."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from bayesfric.analysis import Normal
from bayesfric.effects.base import Effect, EffectParameter, State

Array = NDArray[np.float64]


def _constant(p: Mapping[str, Array], state: State) -> Array:
    pull = np.asarray(state.gravity_m_s2) - np.asarray(state.acceleration_m_s2)
    return np.asarray(-p["excess"] * pull * (not state.steady))


EFFECT = Effect(
    name="mass-error",
    acts_on="drive",
    sentence="the mass on the drive side is off by a constant",
    amplitude=EffectParameter(
        name="excess",
        unit="kg",
        meaning="mass on the drive side beyond what is written down",
        prior=Normal(mean=0.0, sd=0.01),
        plausible=(-0.005, 0.005),
        reference="argued: a hook or a clamp that was not weighed is a few grams, and kitchen "
        "scales are no better",
    ),
    laws={"constant": _constant},
    edge={"n_pulleys": 5.0},
)

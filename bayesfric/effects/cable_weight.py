"""Weight of the cable that passes from one side to the other."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from bayesfric.analysis import HalfNormal
from bayesfric.effects.base import Effect, EffectParameter, State

Array = NDArray[np.float64]
TRAVEL_M = 0.6  # of a trial; half way both sides hang equally long


def _passing(p: Mapping[str, Array], state: State) -> Array:
    longer = 2 * np.asarray(state.travel_m) - TRAVEL_M  # the drive side, beyond the load side
    weight = p["density"] * np.asarray(state.gravity_m_s2) * (not state.steady)
    return np.asarray(-weight * longer)


EFFECT = Effect(
    name="cable-weight",
    acts_on="drive",
    sentence="cable passes from the load side to the drive side, and its weight drives",
    amplitude=EffectParameter(
        name="density",
        unit="kg/m",
        meaning="mass of a metre of cable",
        prior=HalfNormal(scale=0.02),
        plausible=(0.0, 0.003),
        reference="argued: steel that fills 0.5 to 0.7 of a circle of 0.61 mm weighs 1.2 to "
        "1.6 g/m; twice that where a cable is coated or doubled",
    ),
    laws={"passing": _passing},
    edge={"travel_m": TRAVEL_M, "n_pulleys": 5.0},
    along_path=True,
)

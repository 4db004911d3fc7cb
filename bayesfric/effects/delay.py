"""The drive force acts later than the log says."""

import numpy as np

from bayesfric.analysis import HalfNormal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State


def _late(p: Parameters, state: State) -> Array:
    # The logged force exceeds the acting one by F(t) − F(t − d) = d F'(t − d/2), up to d³.
    return np.asarray(p["time"] * np.asarray(state.force_rate_n_s))


EFFECT = Effect(
    name="delay",
    acts_on="drive",
    sentence="the drive force acts later than the log says",
    amplitude=EffectParameter(
        name="time",
        unit="s",
        meaning="time from the logged force to the force that acts",
        prior=HalfNormal(scale=0.01),
        plausible=(0.0, 0.05),
        reference="argued: field buses and drives need one to several cycles of 1 to 10 ms",
    ),
    laws={"late": _late},
    along_path=True,
    needs=frozenset({"drive"}),
    # Beside a law with inertia and viscous friction it shows just after friction has reversed.
    axes=frozenset({"acceleration", "travel_since_reversal", "velocity"}),
)

"""An actuator that follows its command with a time constant."""

import numpy as np

from bayesfric.analysis import HalfNormal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State


def _first_order(p: Parameters, state: State) -> Array:
    # τ F_a' + F_a = F: the command F exceeds the acting force F_a by τ F_a'.
    return np.asarray(p["time"] * np.asarray(state.lagging_rate_n_s))


EFFECT = Effect(
    name="actuator-lag",
    acts_on="drive",
    sentence="the actuator follows its command with a lag",
    amplitude=EffectParameter(
        name="time",
        unit="s",
        meaning="time constant of the actuator",
        prior=HalfNormal(scale=0.01),
        plausible=(0.0, 0.05),
        reference="argued: current loops take a millisecond or less, hydraulic and pneumatic "
        "drives tens of milliseconds",
    ),
    laws={"first-order": _first_order},
    along_path=True,
    needs=frozenset({"drive", "commanded-force"}),
    # Beside a law with inertia and viscous friction it shows just after friction has reversed.
    axes=frozenset({"acceleration", "travel_since_reversal", "velocity"}),
)

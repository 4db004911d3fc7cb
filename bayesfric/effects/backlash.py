"""Play in a transmission: after a reversal the drive turns alone, then it catches the load.

While the axis runs through the gap, the friction and the inertia of what lies behind are missing,
whatever they are. At its end the load, which is at rest, is brought to the speed of the drive:
that takes its momentum.
"""

from collections.abc import Mapping

import numpy as np

from bayesfric.analysis import HalfNormal, LogNormal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Law, State
from bayesfric.physics.loads import taken_along

SHARP = 10.0  # the gap closes over a tenth of it


def _gap(heavy: float) -> Law:
    """Return the law of a load with as large a share of the mass, times a number."""

    def law(p: Mapping[str, Array], state: State) -> Array:
        behind, caught = taken_along(state.travel_m, state.speed_m_s, p["gap"], SHARP)
        load = heavy * np.asarray(state.mass_kg)
        missing = (state.friction_n + load * np.asarray(state.acceleration_m_s2)) * behind
        return np.asarray(p["share"] * np.abs(state.direction) * (load * caught - missing))

    return law


LAWS: dict[str, Law] = {
    "friction": _gap(0.0),
    "half-mass": _gap(0.5),
    "mass": _gap(1.0),
}
EFFECT = Effect(
    name="backlash",
    acts_on="drive",
    sentence="after a reversal the drive runs through play before it takes the load along",
    amplitude=EffectParameter(
        name="share",
        unit="1",
        meaning="part of the friction that is behind the gap, and of the mass none, half as "
        "large a part, or as large a one",
        prior=HalfNormal(scale=0.5),
        plausible=(0.0, 1.0),
        reference="by definition: between nothing and all of it is behind the gap",
    ),
    shape=EffectParameter(
        name="gap",
        unit="m",
        meaning="play",
        prior=LogNormal(median=0.004, sd_log=1.0),
        plausible=(1e-4, 0.06),
        reference="argued: from a thousandth of the travel to a tenth of it, which one would see",
        typical=0.01,
    ),
    laws=LAWS,
    along_path=True,
    needs=frozenset({"direction", "drive"}),
)

"""Backlash in a transmission: the drive moves alone, then it catches the load.

A load without mass stands still after a reversal until the drive has crossed the gap. A load with
mass coasts. If the drive decelerates faster than friction decelerates the load, the load crosses
the gap. It is caught on the other side, takes the drive's speed and loses its excess momentum.
"""

import numpy as np

from bayesfric.analysis import HalfNormal, LogNormal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Law, Parameters, State, load_law
from bayesfric.physics.loads import taken_along

SHARP = 10.0  # the load is picked up over a tenth of the gap


def _light(p: Parameters, state: State) -> Array:
    behind, _ = taken_along(state.travel_m, state.speed_m_s, p["gap"], SHARP)
    return np.asarray(-p["share"] * np.abs(state.direction) * state.friction_n * behind)


LAWS: dict[str, Law] = {
    "friction": _light,
    "half-mass": load_law("play", "gap", 0.5),
    "mass": load_law("play", "gap", 1.0),
    "mass-alone": load_law("play", "gap", np.inf),
}
EFFECT = Effect(
    name="backlash",
    acts_on="drive",
    sentence="after a reversal the drive crosses the backlash before it moves the load",
    amplitude=EffectParameter(
        name="share",
        unit="1",
        meaning="share of the friction that is behind the backlash. By variant, the share of the "
        "mass behind it is 0, half of this share, or this share. In `mass-alone` only mass is "
        "behind it",
        prior=HalfNormal(scale=0.5),
        plausible=(0.0, 1.0),
        reference="by definition: the share behind the backlash is between 0 and 1",
    ),
    shape=EffectParameter(
        name="gap",
        unit="m",
        meaning="width of the backlash",
        prior=LogNormal(median=0.004, sd_log=1.0),
        plausible=(1e-4, 0.06),
        reference="argued: from a thousandth of the travel to a tenth of it; a larger backlash "
        "would be visible",
        typical=0.01,
    ),
    laws=LAWS,
    along_path=True,
    needs=frozenset({"direction", "drive", "play"}),
    axes=frozenset({"acceleration", "travel_since_reversal", "velocity"}),
)

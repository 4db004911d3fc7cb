"""A gear that loses more of its load when driving than when driven back, or the other way.

Duclusaud et al. have |k_m τ_m − k_e τ_e|, τ_m the motor's torque and τ_e that of the load. At
one pose the two of them differ by friction and inertia alone, so that the formula is k |ℓ| with
one k where the motor drives and another where the load drives back. The half of it that is odd,
k ℓ along the motion, is an error of the force's gain, of the mass or of gravity: it shows only
where these are known. With ``load-friction`` it shares the other half.
"""

from collections.abc import Mapping
from functools import partial

import numpy as np

from bayesfric.analysis import HalfNormal
from bayesfric.arrays import Array
from bayesfric.effects.base import LADDER, Effect, EffectParameter, State


def _one_way(load: str, sign: float, p: Mapping[str, Array], state: State) -> Array:
    """Return k |ℓ| where the motor drives (sign 1), or where the load drives it back (−1)."""
    along = sign * np.asarray(getattr(state, load)) * np.asarray(state.direction)
    return np.asarray(p["share"] * np.maximum(along, 0.0))


EFFECT = Effect(
    name="load-asymmetry",
    acts_on="drive",
    sentence="the gear's loss per load differs between driving and being driven back",
    amplitude=EffectParameter(
        name="share",
        unit="1",
        meaning="additional friction per unit of load, in one direction of the power only",
        prior=HalfNormal(scale=0.2),
        plausible=(0.0, 0.5),
        reference=f"{LADDER}: 0 to 0.38 on the motor's side, 0 to 0.25 on the other",
    ),
    laws={
        "driving": partial(_one_way, "carried_n", 1.0),
        "driven-back": partial(_one_way, "carried_n", -1.0),
        "driving-what-is-held": partial(_one_way, "held_n", 1.0),
        "driven-back-by-what-is-held": partial(_one_way, "held_n", -1.0),
    },
    along_path=True,
    needs=frozenset({"direction", "load-both-ways", "known-load"}),
    axes=frozenset({"load", "displacement", "acceleration"}),
)

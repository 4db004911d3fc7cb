"""A gear whose friction per load differs between driving and being driven back.

Duclusaud et al. have |k_m τ_m − k_e τ_e|, with the motor's torque τ_m and the load's torque τ_e. At
one pose the two differ only by friction and inertia. So the formula is k |ℓ|, with one k if the
motor drives and another if the load drives back. The odd half of it, k ℓ along the motion, looks
like an error of the force's gain, of the mass or of gravity, and shows only if these are known. The
even half is the same as ``load-friction``.
"""

from functools import partial

import numpy as np

from bayesfric.analysis import HalfNormal
from bayesfric.arrays import Array
from bayesfric.effects.base import LADDER, Effect, EffectParameter, Parameters, State


def _one_way(load: str, sign: float, p: Parameters, state: State) -> Array:
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

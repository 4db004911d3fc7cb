"""Coulomb friction that a simulator of an axis lacks: a force against the motion at any speed.

It is examined if the law, or the simulator that replaces it, has no Coulomb friction to fit. In
motion in one direction only, it cannot be told from a weight or from an offset (``axis-bias``).
"""

import numpy as np

from bayesfric.analysis import HalfNormal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State


def _constant(p: Parameters, state: State) -> Array:
    return np.asarray(p["force"] * np.abs(np.asarray(state.direction)))


EFFECT = Effect(
    name="coulomb-missing",
    acts_on="friction",
    sentence="your simulator has no Coulomb friction, or too little",
    amplitude=EffectParameter(
        name="force",
        unit="N",
        meaning="Coulomb friction that is missing",
        prior=HalfNormal(scale=1.5),
        plausible=(0.0, 3.0),
        reference="argued: about the Coulomb friction that least squares estimates",
    ),
    laws={"constant": _constant},
    along_path=True,
    needs=frozenset({"direction", "law-without-coulomb"}),
    axes=frozenset({"direction"}),
)

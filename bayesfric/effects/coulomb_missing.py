"""Coulomb friction that a simulator of an axis lacks: a force against the motion at any speed.

It is examined where the law, or the simulator in its place, has no Coulomb friction to fit. Along
a motion that never turns it cannot be told from a weight or from an offset (``axis-bias``).
"""

from collections.abc import Mapping

import numpy as np

from bayesfric.analysis import HalfNormal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, State


def _constant(p: Mapping[str, Array], state: State) -> Array:
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
        reference="argued: about the Coulomb friction that plain least squares estimate",
    ),
    laws={"constant": _constant},
    along_path=True,
    needs=frozenset({"direction", "law-without-coulomb"}),
    axes=frozenset({"direction"}),
)

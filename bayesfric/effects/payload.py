"""Mass that moves in the runs that show the gap, and that the baseline has not."""

from collections.abc import Mapping

import numpy as np

from bayesfric.analysis import Normal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, State


def _carried(p: Mapping[str, Array], state: State) -> Array:
    moved = np.asarray(state.acceleration_m_s2) * np.asarray(state.tested)
    return np.asarray(p["mass"] * moved)


EFFECT = Effect(
    name="payload",
    acts_on="drive",
    sentence="the runs that show the gap move more mass than the baseline has",
    amplitude=EffectParameter(
        name="mass",
        unit="kg",
        meaning="mass, or inertia, that runs move beyond the baseline's: those of role test, or, "
        "where no run is only a test, those without a role",
        prior=Normal(mean=0.0, sd=0.5),
        plausible=(-0.5, 2.0),
        reference="argued: what an axis carries is up to some times its own mass; what it lost "
        "is less than half of it",
    ),
    laws={"carried": _carried},
    along_path=True,
    needs=frozenset({"test"}),
    axes=frozenset({"acceleration"}),
)

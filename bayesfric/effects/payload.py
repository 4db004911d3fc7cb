"""Additional mass in the runs that show the gap, beyond the mass of the baseline."""

import numpy as np

from bayesfric.analysis import Normal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State


def _carried(p: Parameters, state: State) -> Array:
    moved = np.asarray(state.acceleration_m_s2) * np.asarray(state.tested)
    return np.asarray(p["mass"] * moved)


EFFECT = Effect(
    name="payload",
    acts_on="drive",
    sentence="the test runs carry an additional mass",
    amplitude=EffectParameter(
        name="mass",
        unit="kg",
        meaning="additional mass (or inertia) of the runs of role `test`, or of the runs without a "
        "role if there are none",
        prior=Normal(mean=0.0, sd=0.5),
        plausible=(-0.5, 2.0),
        reference="argued: a payload is up to several times the mass of the axis. A missing part "
        "is less than half of it",
    ),
    laws={"carried": _carried},
    along_path=True,
    needs=frozenset({"test"}),
    axes=frozenset({"acceleration"}),
)

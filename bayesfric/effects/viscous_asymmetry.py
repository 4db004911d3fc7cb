"""Viscous friction that differs between the two directions of an axis.

It is confounded with ``direction-asymmetry`` if the axis runs at one speed, and with a drive whose
back-EMF differs between the directions.
"""

import numpy as np

from bayesfric.analysis import Normal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State


def _per_speed(p: Parameters, state: State) -> Array:
    along = np.asarray(state.speed_m_s) * np.asarray(state.direction)
    return np.asarray(p["slope"] * along * np.asarray(state.pulley_friction_n))


EFFECT = Effect(
    name="viscous-asymmetry",
    acts_on="friction",
    sentence="viscous friction differs between the two directions",
    amplitude=EffectParameter(
        name="slope",
        unit="s/m",
        meaning="growth with speed in the positive direction beyond the mean of both, as a share "
        "of Coulomb friction",
        prior=Normal(mean=0.0, sd=0.15),
        plausible=(-0.7, 0.7),
        reference="argued: as much as viscous friction itself, which costs up to several times "
        "Coulomb friction at the top speed of a geared joint",
    ),
    laws={"per-speed": _per_speed},
    along_path=True,
    needs=frozenset({"direction"}),
    axes=frozenset({"direction", "velocity"}),
)

"""Stiction: the longer an axis has rested, the more it takes to get it going.

Contacts creep while nothing moves; the rise dies out over the first stretch of travel. It is
confounded with ``stribeck`` where every start is alike, and with ``presliding`` of other sign.
"""

from collections.abc import Mapping

import numpy as np

from bayesfric.analysis import HalfNormal, LogNormal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, State

RISES_IN_S = 1.0  # of dwell, to half of what it can be


def _after_dwell(p: Mapping[str, Array], state: State) -> Array:
    dwell = np.asarray(state.dwell_s)
    rise = p["rise"] * np.asarray(state.pulley_friction_n) * dwell / (dwell + RISES_IN_S)
    return np.asarray(rise * np.exp(-np.asarray(state.since_rest_m) / p["length"]))


EFFECT = Effect(
    name="stiction",
    acts_on="friction",
    sentence="after a rest a larger force is needed to start the axis",
    amplitude=EffectParameter(
        name="rise",
        unit="1",
        meaning="extra friction after a long rest, as a share of Coulomb friction",
        prior=HalfNormal(scale=0.5),
        plausible=(0.0, 2.0),
        reference="Armstrong-Hélouvry, Dupont and Canudas de Wit, Automatica 30 (1994) 1083: "
        "static friction that rises with dwell time, to about twice the kinetic",
    ),
    shape=EffectParameter(
        name="length",
        unit="m",
        meaning="travel over which it dies out to 1/e",
        prior=LogNormal(median=0.02, sd_log=0.8),
        plausible=(1e-4, 0.1),
        reference="argued: from the size of a contact to some turns of a gear's teeth",
        typical=0.02,
    ),
    laws={"after-dwell": _after_dwell},
    along_path=True,
    needs=frozenset({"direction", "dwell"}),
    axes=frozenset({"displacement", "time"}),
)

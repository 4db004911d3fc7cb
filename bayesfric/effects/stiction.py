"""Stiction: the longer an axis has rested, the larger the force that starts it.

Contacts creep while nothing moves. The extra friction decays over the first stretch of travel. The
effect is confounded with ``stribeck`` if all starts are alike. Its sign is opposite to that of
``presliding``, with which it is confounded too.
"""

import numpy as np

from bayesfric.analysis import HalfNormal, LogNormal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State

RISES_IN_S = 1.0  # dwell after which the extra friction is half of its maximum


def _after_dwell(p: Parameters, state: State) -> Array:
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
        "static friction rises with dwell time, to about twice the kinetic friction",
    ),
    shape=EffectParameter(
        name="length",
        unit="m",
        meaning="travel over which the extra friction falls to 1/e",
        prior=LogNormal(median=0.02, sd_log=0.8),
        plausible=(1e-4, 0.1),
        reference="argued: from the size of a contact to a few teeth of a gear",
        typical=0.02,
    ),
    laws={"after-dwell": _after_dwell},
    along_path=True,
    needs=frozenset({"direction", "dwell"}),
    axes=frozenset({"displacement", "time"}),
)

"""Presliding: friction builds up over the first stretch of travel."""

import numpy as np

from bayesfric.analysis import HalfNormal, LogNormal
from bayesfric.arrays import Array
from bayesfric.effects.base import (
    Effect,
    EffectParameter,
    Parameters,
    State,
    after_passes,
    exponentially,
)


def _rational(p: Parameters, state: State) -> Array:
    unsettled = 1 / (1 + np.asarray(state.travel_m) / p["length"])
    return -p["share"] * state.settling_friction_n * unsettled


EFFECT = Effect(
    name="presliding",
    acts_on="friction",
    sentence="friction builds up over the first stretch of travel",
    amplitude=EffectParameter(
        name="share",
        unit="1",
        meaning="share of friction that is missing at the start of a trial",
        prior=HalfNormal(scale=0.5),
        plausible=(0.0, 1.0),
        reference="argued: friction that is built up from rest starts between nothing and all "
        "of it",
    ),
    shape=EffectParameter(
        name="length",
        unit="m",
        meaning="travel over which friction builds up: to 1/e of what was missing, or to half",
        prior=LogNormal(median=0.02, sd_log=0.7),
        plausible=(1e-4, 0.036),
        reference="argued: from the stretch of the cable under 1 N of friction, 0.1 mm, to half "
        "a turn of the large pulley, over which its balls and grease come to their paths",
        typical=0.02,
    ),
    laws={"exponential": exponentially, "rational": _rational},
    turning={"after-passes": after_passes},
    edge={"travel_m": 0.0},
    along_path=True,
    needs=frozenset({"turns"}),
    axes=frozenset({"displacement", "travel_since_reversal"}),
)

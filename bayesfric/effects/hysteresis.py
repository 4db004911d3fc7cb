"""Hysteresis: friction that takes a long travel to settle after the last reversal.

Dahl's model from rest, dz/dx = (1 − z)/L, has the same curve as ``presliding``. A board whose
cable runs in one direction only cannot tell the two apart, except by their lengths. The model of
Bouc and Wen with exponent 2, dz/dx = (1 − z²)/L, has another curve.
"""

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


def _bouc_wen(p: Parameters, state: State) -> Array:
    unsettled = 1 - np.tanh(np.asarray(state.travel_m) / p["length"])
    return np.asarray(-p["share"] * state.settling_friction_n * unsettled)


EFFECT = Effect(
    name="hysteresis",
    acts_on="friction",
    sentence="friction depends on the path since the last reversal",
    amplitude=EffectParameter(
        name="share",
        unit="1",
        meaning="share of friction that is missing when the cable starts to run",
        prior=HalfNormal(scale=0.5),
        plausible=(0.0, 1.0),
        reference="argued: from rest the state of Dahl's model (A Solid Friction Model, "
        "Aerospace Corporation, 1968) lies between none and all of friction",
    ),
    shape=EffectParameter(
        name="length",
        unit="m",
        meaning="travel over which the past is forgotten",
        prior=LogNormal(median=0.04, sd_log=0.7),
        plausible=(1e-4, 0.3),
        reference="argued: from the stretch of the cable under 1 N of friction to half the travel "
        "of the board",
        typical=0.04,
    ),
    laws={"dahl": exponentially, "bouc-wen": _bouc_wen},
    turning={"after-passes": after_passes},
    edge={"travel_m": 0.0},
    along_path=True,
    needs=frozenset({"turns"}),
    axes=frozenset({"displacement", "travel_since_reversal"}),
)

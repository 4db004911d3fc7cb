"""Friction by the gear's load that dies out as speed grows: k |ℓ| exp(−v / v_s).

M4 of Duclusaud et al. At high speed friction by the load may stay, half of it or less: that is
``load-friction``, which therefore is no effect beside this one but a part of it. The two are not
told apart where all is slow; where the load is always the same this is ``stribeck``.
"""

from collections.abc import Mapping

import numpy as np

from bayesfric.analysis import HalfNormal, LogNormal
from bayesfric.arrays import Array
from bayesfric.effects.base import BY_LOAD, LADDER, Effect, EffectParameter, State


def _exponential(p: Mapping[str, Array], state: State) -> Array:
    return np.asarray(p["share"] * np.abs(np.asarray(state.carried_n)) * _dying(p, state))


def _at_rest(p: Mapping[str, Array], state: State) -> Array:
    return np.asarray(p["share"] * np.abs(np.asarray(state.held_n)) * _dying(p, state))


def _half_stays(p: Mapping[str, Array], state: State) -> Array:
    left = 0.5 * (1 + _dying(p, state))
    return np.asarray(p["share"] * np.abs(np.asarray(state.carried_n)) * left)


def _dying(p: Mapping[str, Array], state: State) -> Array:
    return np.asarray(np.exp(-np.asarray(state.speed_m_s) / p["speed"]))


EFFECT = Effect(
    name="load-stribeck",
    acts_on="drive",
    sentence="friction that grows with the gear's load is higher at low speed",
    amplitude=EffectParameter(
        name="share",
        unit="1",
        meaning="additional friction at standstill per unit of load",
        prior=HalfNormal(scale=0.15),
        plausible=(0.0, 0.5),
        reference=f"{LADDER}: 0.05 to 0.25",
    ),
    shape=EffectParameter(
        name="speed",
        unit="m/s",
        meaning="Stribeck speed, at which it has fallen to 1/e",
        prior=LogNormal(median=0.25, sd_log=0.7),
        plausible=(0.005, 1.3),
        reference=f"{LADDER}: 0.35 to 4.2 rad/s, of joints that reach some rad/s",
        typical=0.25,
    ),
    laws={"exponential": _exponential, "of-what-is-held": _at_rest, "half-stays": _half_stays},
    along_path=True,
    needs=frozenset({"direction", "load-both-ways"}),
    axes=frozenset({"load", "velocity", "displacement"}),
    ladder=BY_LOAD,
)

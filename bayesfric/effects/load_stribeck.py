"""Friction from the gear's load that decays with speed: k |ℓ| exp(−v / v_s).

This is M4 of Duclusaud et al. Half of the friction or less may remain at high speed. That part is
``load-friction``, so the two are rungs of one ladder and never act together. They cannot be told
apart if all speeds are low. If the load is always the same, this effect is ``stribeck``.
"""

import numpy as np

from bayesfric.analysis import HalfNormal, LogNormal
from bayesfric.arrays import Array
from bayesfric.effects.base import BY_LOAD, LADDER, Effect, EffectParameter, Parameters, State


def _exponential(p: Parameters, state: State) -> Array:
    return np.asarray(p["share"] * np.abs(np.asarray(state.carried_n)) * _decay(p, state))


def _at_rest(p: Parameters, state: State) -> Array:
    return np.asarray(p["share"] * np.abs(np.asarray(state.held_n)) * _decay(p, state))


def _half_stays(p: Parameters, state: State) -> Array:
    left = 0.5 * (1 + _decay(p, state))
    return np.asarray(p["share"] * np.abs(np.asarray(state.carried_n)) * left)


def _decay(p: Parameters, state: State) -> Array:
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
        meaning="Stribeck speed, at which the friction has fallen to 1/e",
        prior=LogNormal(median=0.25, sd_log=0.7),
        plausible=(0.005, 1.3),
        reference=f"{LADDER}: 0.35 to 4.2 rad/s, of joints that reach a few rad/s",
        typical=0.25,
    ),
    laws={"exponential": _exponential, "of-what-is-held": _at_rest, "half-stays": _half_stays},
    along_path=True,
    needs=frozenset({"direction", "load-both-ways"}),
    axes=frozenset({"load", "velocity", "displacement"}),
    ladder=BY_LOAD,
)

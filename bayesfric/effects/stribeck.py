"""Stribeck friction: friction is higher at low speed, and the rise decays with speed."""

import numpy as np

from bayesfric.analysis import HalfNormal, LogNormal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State

ARMSTRONG = (
    "argued from the survey of Armstrong-Hélouvry, Dupont and Canudas de Wit, Automatica 30 "
    "(1994) 1083: "
)


def _exponential(p: Parameters, state: State) -> Array:
    return p["rise"] * state.friction_n * np.exp(-np.asarray(state.speed_m_s) / p["speed"])


def _gaussian(p: Parameters, state: State) -> Array:
    ratio = np.asarray(state.speed_m_s) / p["speed"]
    return p["rise"] * state.friction_n * np.exp(-(ratio**2))


EFFECT = Effect(
    name="stribeck",
    acts_on="friction",
    sentence="friction is higher at low speed and falls as speed grows",
    amplitude=EffectParameter(
        name="rise",
        unit="1",
        meaning="extra friction at standstill as a share of friction",
        prior=HalfNormal(scale=0.3),
        plausible=(0.0, 1.0),
        reference=f"{ARMSTRONG}at most twice the kinetic friction at rest",
        on_joints=(
            0.0,
            3.0,
            "in geared servos most of the friction at rest may vanish with speed: Duclusaud "
            "et al., Extended friction models for the physics simulation of servo actuators, "
            "2024, M2",
        ),
    ),
    shape=EffectParameter(
        name="speed",
        unit="m/s",
        meaning="Stribeck speed, at which the rise has fallen to 1/e",
        prior=LogNormal(median=0.15, sd_log=0.7),
        plausible=(0.001, 0.3),
        reference=f"{ARMSTRONG}the rise is limited to low speeds",
        on_joints=(
            0.001,
            1.3,
            "0.35 to 4.2 rad/s in servos that reach a few rad/s (parameters published with "
            "Duclusaud et al., Extended friction models for the physics simulation of servo "
            "actuators, 2024); less in sliding contacts",
        ),
        typical=0.15,
    ),
    laws={"exponential": _exponential, "gaussian": _gaussian},
    edge={"speed_m_s": 0.0},
    along_path=True,
    axes=frozenset({"velocity"}),
)

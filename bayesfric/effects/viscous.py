"""Viscous friction: grows in proportion to speed, as lubricant in the bearings does."""

import numpy as np

from bayesfric.analysis import HalfNormal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State
from bayesfric.effects.state import REFERENCE_TENSION_N
from bayesfric.physics.friction import REFERENCE_WRAP_ANGLE_DEG


def _constant(p: Parameters, state: State) -> Array:
    scale = np.asarray(state.n_pulleys) * np.asarray(state.pulley_friction_n)
    return np.asarray(p["slope"] * np.asarray(state.speed_m_s) * scale)


def _with_tension(p: Parameters, state: State) -> Array:
    return _constant(p, state) * (np.asarray(state.tension_n) / REFERENCE_TENSION_N)


def _with_wrap(p: Parameters, state: State) -> Array:
    return _constant(p, state) * (np.asarray(state.wrap_angle_deg) / REFERENCE_WRAP_ANGLE_DEG)


def _with_friction(p: Parameters, state: State) -> Array:
    return np.asarray(p["slope"] * np.asarray(state.speed_m_s) * state.friction_n)


EFFECT = Effect(
    name="viscous",
    acts_on="friction",
    sentence="friction grows in proportion to speed",
    amplitude=EffectParameter(
        name="slope",
        unit="s/m",
        meaning="growth with speed, as a share of the friction of a pulley at 15 N and 85°",
        prior=HalfNormal(scale=0.15),
        plausible=(0.0, 0.3),
        reference="argued: at 1.3 m/s lubricant should not cost more than 0.4 of what load costs;"
        " that bearings have a load and a speed part is textbook (Harris and Kotzalas, "
        "Essential Concepts of Bearing Technology, 2006)",
        on_joints=(
            0.0,
            4.0,
            "of six geared servos and harmonic drives it is 0.1 to 1.5 of Coulomb friction at "
            "1 rad/s (parameters published with Duclusaud et al., Extended friction models for "
            "the physics simulation of servo actuators, 2024): at a joint's top speed up to five "
            "times Coulomb friction",
        ),
    ),
    laws={
        "constant": _constant,
        "tension": _with_tension,
        "wrap": _with_wrap,
        "friction": _with_friction,
    },
    edge={"speed_m_s": 1.3},
    along_path=True,
    axes=frozenset({"velocity"}),
)

"""Friction that is not linear in tension."""

import numpy as np

from bayesfric.analysis import Normal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State
from bayesfric.effects.state import REFERENCE_TENSION_N

MIDDLE_TENSION_N = 16.5  # of Table II's range
SLACK = 1e-3  # share of that: a lower tension counts as a slack cable


def _quadratic(p: Parameters, state: State) -> Array:
    beyond = np.asarray(state.tension_n) / MIDDLE_TENSION_N - 1
    return np.asarray(p["curvature"] * np.asarray(state.tension_friction_n) * beyond)


def _apart_from_wrap(p: Parameters, state: State) -> Array:
    # n c1 T as at 85°, at any angle; c1 from the friction of one pulley at 15 N and 85°.
    whole = np.asarray(state.n_pulleys) * np.asarray(state.pulley_friction_n)
    slope = (whole - np.asarray(state.constant_friction_n)) / REFERENCE_TENSION_N
    beyond = np.asarray(state.tension_n) / MIDDLE_TENSION_N - 1
    return np.asarray(p["curvature"] * slope * np.asarray(state.tension_n) * beyond)


def _power(p: Parameters, state: State) -> Array:
    # Far from a board's trials the law may make the cable slack, which has no power.
    ratio = np.maximum(np.asarray(state.tension_n) / MIDDLE_TENSION_N, SLACK)
    grown = np.expm1(p["curvature"] * np.log(ratio))
    return np.asarray(state.tension_friction_n) * grown


EFFECT = Effect(
    name="tension-curvature",
    acts_on="friction",
    sentence="friction is not a straight line in tension",
    amplitude=EffectParameter(
        name="curvature",
        unit="1",
        meaning="curvature a: the friction that grows with tension T is multiplied by "
        "1 + a (T/16.5 N − 1); in the variant `power`, by T/16.5 N to the power a",
        prior=Normal(mean=0.0, sd=0.2),
        plausible=(-0.35, 0.35),
        reference="argued from contact laws, whose exponents lie a third around one: a point "
        "contact's area grows as load to 2/3, a ball's rolling moment as load to 4/3 "
        "(Johnson, Contact Mechanics, 1985)",
        by_law={
            "quadratic": "curvature a: the friction that grows with tension T is multiplied by "
            "1 + a (T/16.5 N − 1)",
            "apart-from-wrap": "curvature a: n c₁ T, the friction that grows with tension at 85°, "
            "grows by the share a (T/16.5 N − 1)",
            "power": "curvature a: the friction that grows with tension T is multiplied by "
            "(T/16.5 N)ᵃ",
        },
    ),
    laws={"quadratic": _quadratic, "apart-from-wrap": _apart_from_wrap, "power": _power},
    edge={"tension_n": 33.0},
    needs=frozenset({"pulleys"}),
    axes=frozenset({"tension"}),
)

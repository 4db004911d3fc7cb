"""The slope in the wrap angle is proportional to the number of pulleys."""

from collections.abc import Mapping

import numpy as np

from bayesfric.analysis import Normal
from bayesfric.arrays import Array
from bayesfric.claims.base import Claim
from bayesfric.claims.comparison import compare
from bayesfric.effects import Effect, EffectParameter, State
from bayesfric.fitting.hypothesis import LawWithEffects
from bayesfric.observation.coefficients import MIDDLE_TENSION_N

MIDDLE_PULLEYS, MIDDLE_WRAP_DEG, SPAN_DEG = 9.0, 85.0, 50.0


def _turn(state: State) -> Array:
    """Return a pulley's friction at 15 N and 85°, times tension and angle away from there."""
    turn = (np.asarray(state.wrap_angle_deg) - MIDDLE_WRAP_DEG) / SPAN_DEG
    load = np.asarray(state.tension_n) / MIDDLE_TENSION_N
    return np.asarray(np.asarray(state.pulley_friction_n) * turn * load)


def _bent(p: Mapping[str, Array], state: State) -> Array:
    n = np.asarray(state.n_pulleys)
    return np.asarray(p["departure"] * n * (n / MIDDLE_PULLEYS - 1) * _turn(state))


def _offset(p: Mapping[str, Array], state: State) -> Array:
    # A term that does not grow with n; the slope falls by as much at nine pulleys.
    rest = MIDDLE_PULLEYS - np.asarray(state.n_pulleys)
    return np.asarray(p["departure"] * rest * _turn(state))


DEPARTURE = Effect(
    name="wrap-slope",
    acts_on="friction",
    sentence="the slope in the wrap angle is not proportional to the number of pulleys",
    amplitude=EffectParameter(
        name="departure",
        unit="1",
        meaning="change of friction 50° from 85° for twice as many pulleys as nine, beyond "
        "proportion, as a share of the friction of a pulley at 85°",
        prior=Normal(mean=0.0, sd=0.1),
        plausible=(-0.1, 0.1),
        reference="argued: as large as the slope itself, 10 % of friction at 50° (Table I)",
    ),
    laws={"bent": _bent, "offset": _offset},
    edge={"wrap_angle_deg": 150.0, "n_pulleys": 19.0},
)

CLAIM = Claim(
    name="wrap-slope-proportional",
    place=7,
    statement="The slope of friction in the wrap angle is proportional to the number of pulleys.",
    paper="Eqs (10) and (11): the slope in θ is c3 T n, without an offset.",
    judge=compare,
    regime="accelerated",
    instead="steady",
    effects=(DEPARTURE,),
    rivals=tuple(LawWithEffects(effects=(("wrap-slope", law),)) for law in DEPARTURE.laws),
    levels={"wrap_angle_deg": 2, "n_pulleys": 2},
)

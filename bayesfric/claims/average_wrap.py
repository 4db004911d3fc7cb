"""Only the average of the individual wrap angles matters."""

from collections.abc import Mapping

import numpy as np

from bayesfric.analysis import Normal
from bayesfric.arrays import Array
from bayesfric.claims.base import Claim
from bayesfric.claims.comparison import compare
from bayesfric.claims.wrap_slope import SPAN_DEG
from bayesfric.effects import Effect, EffectParameter, State
from bayesfric.fitting.hypothesis import LawWithEffects
from bayesfric.observation.coefficients import MIDDLE_TENSION_N


def _loaded(p: Mapping[str, Array], state: State) -> Array:
    return np.asarray(_constant(p, state) * np.asarray(state.tension_n) / MIDDLE_TENSION_N)


def _constant(p: Mapping[str, Array], state: State) -> Array:
    # If friction is curved in the individual angle, its sum contains their variance.
    variance = (np.asarray(state.wrap_spread_deg) / SPAN_DEG) ** 2
    scale = np.asarray(state.n_pulleys) * np.asarray(state.pulley_friction_n)
    return np.asarray(p["of_spread"] * scale * variance)


SPREAD = Effect(
    name="wrap-spread",
    acts_on="friction",
    sentence="friction depends on how the wrap angle is shared out among the pulleys",
    amplitude=EffectParameter(
        name="of_spread",
        unit="1",
        meaning="change of friction where individual wrap angles have a standard deviation of "
        "50°, as a share of the friction of a pulley at 85°",
        prior=Normal(mean=0.0, sd=0.2),
        plausible=(-0.2, 0.2),
        reference="argued: a curvature in the angle as large as its slope, 10 % in 50° (Table I)",
    ),
    laws={"loaded": _loaded, "constant": _constant},
    edge={"wrap_spread_deg": 50.0},
)

CLAIM = Claim(
    name="average-wrap",
    place=8,
    statement="Of the individual wrap angles only the average matters.",
    paper="θ is the average of the individual wrap angles (eqs (15), (16); Table II).",
    judge=compare,
    regime="accelerated",
    effects=(SPREAD,),
    rivals=tuple(LawWithEffects(effects=(("wrap-spread", law),)) for law in SPREAD.laws),
)

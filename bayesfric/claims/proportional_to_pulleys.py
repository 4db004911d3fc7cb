"""Friction is proportional to the number of pulleys."""

from bayesfric.claims.base import Claim
from bayesfric.claims.comparison import compare
from bayesfric.fitting.hypothesis import LawWithEffects

CLAIM = Claim(
    name="proportional-to-pulleys",
    place=5,
    statement="Friction is proportional to the number of pulleys, without an offset.",
    paper="Slope and intercept of fc in T are proportional to n (eqs (6), (7)).",
    judge=compare,
    regime="accelerated",
    instead="steady",
    rivals=(
        LawWithEffects(effects=(("fixed-drag", "constant"),)),
        LawWithEffects(effects=(("pulley-count-curvature", "power"),)),
    ),
    levels={"n_pulleys": 2},
)

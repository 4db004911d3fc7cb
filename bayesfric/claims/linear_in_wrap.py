"""Friction is linear in the wrap angle, in proportion to tension."""

from bayesfric.claims.base import Claim
from bayesfric.claims.comparison import compare
from bayesfric.fitting.hypothesis import LawWithEffects

CLAIM = Claim(
    name="linear-in-wrap",
    place=6,
    statement="Friction is a straight line in the wrap angle, and only its part that grows with "
    "tension depends on the angle.",
    paper="fc is linear in θ (Fig. 14), its slope proportional to n (eqs (10), (11)) and to T "
    "(eq. (9)); c2 does not depend on θ.",
    judge=compare,
    regime="accelerated",
    instead="steady",
    rivals=(
        LawWithEffects(effects=(("wrap-curvature", "quadratic"),)),
        LawWithEffects(effects=(("wrap-intercept", "linear"),)),
        LawWithEffects("no-wrap"),
        LawWithEffects("bearing-load"),
    ),
    levels={"wrap_angle_deg": 3},
)

"""Friction is linear in tension."""

from bayesfric.claims.base import Claim
from bayesfric.claims.comparison import compare
from bayesfric.fitting.hypothesis import LawWithEffects

CLAIM = Claim(
    name="linear-in-tension",
    place=4,
    statement="Friction is a straight line in tension.",
    paper="fc is linear in T at 85°, with R² above 0.99 for each size and n (Fig. 12).",
    judge=compare,
    regime="accelerated",
    instead="steady",
    rivals=tuple(
        LawWithEffects(effects=(("tension-curvature", law),)) for law in ("quadratic", "power")
    ),
    levels={"tension": 3},
)

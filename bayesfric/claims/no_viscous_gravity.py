"""No viscous term on the gravity board."""

from bayesfric.claims.base import Claim
from bayesfric.claims.comparison import compare
from bayesfric.fitting.hypothesis import LawWithEffects

CLAIM = Claim(
    name="no-viscous-gravity",
    place=2,
    statement="The friction of a cable that a falling weight drives does not grow with speed.",
    paper="Trajectories fit without fv; R² of a trial is often above 0.95 (Sec. III.B, Fig. 11).",
    judge=compare,
    regime="accelerated",
    rivals=tuple(
        LawWithEffects(effects=(("viscous", law),)) for law in ("constant", "tension", "wrap")
    ),
)

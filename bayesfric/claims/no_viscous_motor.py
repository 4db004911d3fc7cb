"""No viscous term on the motor board."""

from bayesfric.claims.base import Claim
from bayesfric.claims.comparison import compare
from bayesfric.fitting.hypothesis import LawWithEffects

CLAIM = Claim(
    name="no-viscous-motor",
    place=1,
    statement="Friction at constant speed does not depend on the speed.",
    paper="Friction is the same at every speed, whatever tension (Figs 4, 5), wrap angle (Fig. 6) "
    "or number of pulleys (Fig. 7).",
    judge=compare,
    regime="steady",
    rivals=tuple(
        LawWithEffects(effects=(("viscous", law),)) for law in ("constant", "tension", "wrap")
    ),
)

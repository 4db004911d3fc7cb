"""Evidence of a density and what leaving data out predicts; knows nothing of friction."""

from bayesfric.evidence.bridge import bridge_evidence, bridge_ratio, in_one_place
from bayesfric.evidence.conjugate import LinearGaussian
from bayesfric.evidence.importance import laplace_draws, laplace_evidence, reliable_draws
from bayesfric.evidence.leave_out import ELPD, Difference, difference, elpd, loo_pit
from bayesfric.evidence.nested import savage_dickey
from bayesfric.evidence.record import Evidence, SeparatedModes, agree
from bayesfric.evidence.refit import Refit, refit_without

__all__ = [
    "ELPD",
    "Difference",
    "Evidence",
    "LinearGaussian",
    "Refit",
    "SeparatedModes",
    "agree",
    "bridge_evidence",
    "bridge_ratio",
    "difference",
    "elpd",
    "in_one_place",
    "laplace_draws",
    "laplace_evidence",
    "loo_pit",
    "refit_without",
    "reliable_draws",
    "savage_dickey",
]

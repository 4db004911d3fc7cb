"""Evidence of a density and what leaving data out predicts; knows nothing of friction."""

from bayesfric.inference.evidence.bridge import bridge_evidence, bridge_ratio, in_one_place
from bayesfric.inference.evidence.importance import importance_draws
from bayesfric.inference.evidence.leave_out import ELPD, Difference, difference, elpd, loo_pit
from bayesfric.inference.evidence.record import Evidence, SeparatedModes
from bayesfric.inference.evidence.refit import Refit, refit_without

__all__ = [
    "ELPD",
    "Difference",
    "Evidence",
    "Refit",
    "SeparatedModes",
    "bridge_evidence",
    "bridge_ratio",
    "difference",
    "elpd",
    "importance_draws",
    "in_one_place",
    "loo_pit",
    "refit_without",
]

"""Evidence of a density and what leaving data out predicts; knows nothing of friction."""

from bayesfric.inference.evidence.bridge import bridge_evidence, bridge_ratio, in_one_place
from bayesfric.inference.evidence.importance import LEAST_FOR_A_MEAN, importance_draws
from bayesfric.inference.evidence.leave_out import (
    ELPD,
    Difference,
    Refit,
    Without,
    difference,
    elpd,
    loo_pit,
    refit_without,
    without_each,
)
from bayesfric.inference.evidence.record import Evidence, SeparatedModes

__all__ = [
    "ELPD",
    "LEAST_FOR_A_MEAN",
    "Difference",
    "Evidence",
    "Refit",
    "SeparatedModes",
    "Without",
    "bridge_evidence",
    "bridge_ratio",
    "difference",
    "elpd",
    "importance_draws",
    "in_one_place",
    "loo_pit",
    "refit_without",
    "without_each",
]

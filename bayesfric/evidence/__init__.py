"""Evidence of a density and what leaving data out predicts; knows nothing of friction."""

from bayesfric.evidence.bridge import bridge_evidence
from bayesfric.evidence.importance import laplace_evidence
from bayesfric.evidence.record import Evidence, SeparatedModes, agree

__all__ = ["Evidence", "SeparatedModes", "agree", "bridge_evidence", "laplace_evidence"]

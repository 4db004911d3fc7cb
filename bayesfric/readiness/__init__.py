"""What a recording shows before any work: its telemetry, what it can tell, what to record next."""

from bayesfric.readiness.checking import Readiness, readiness_of, refuse_untold

__all__ = ["Readiness", "readiness_of", "refuse_untold"]

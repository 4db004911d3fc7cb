"""A check before a fit: telemetry, what a recording can determine, and what to record next."""

from bayesfric.readiness.checking import Readiness, readiness_of, refuse_untold

__all__ = ["Readiness", "readiness_of", "refuse_untold"]

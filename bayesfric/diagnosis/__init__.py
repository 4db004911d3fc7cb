"""Where the law misses a recording, what causes it, and how far that shrinks."""

from bayesfric.diagnosis.diagnosing import Diagnosed, diagnose

__all__ = ["Diagnosed", "diagnose"]

"""Where the law misses a recording, what causes it, and how far that shrinks."""

from bayesfric.diagnosis.diagnosed import Diagnosed
from bayesfric.diagnosis.diagnosing import diagnose

__all__ = ["Diagnosed", "diagnose"]

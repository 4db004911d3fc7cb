"""The gap between simulation and reality: where it lies, what causes it, how far it shrinks."""

from bayesfric.diagnosis.diagnosing import Diagnosed, diagnose

__all__ = ["Diagnosed", "diagnose"]

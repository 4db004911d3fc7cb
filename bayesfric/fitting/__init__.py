"""Fits a recording, and stores the posterior and its predictions."""

from bayesfric.fitting.posterior import fit
from bayesfric.fitting.result import Fit

__all__ = ["Fit", "fit"]

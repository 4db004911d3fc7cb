"""A recording and an analysis to a stored posterior."""

from bayesfric.fitting.posterior import Fit, fit

__all__ = ["Fit", "fit"]

"""A recording and an analysis to a stored posterior."""

from bayesfric.fitting.posterior import fit
from bayesfric.fitting.result import Fit

__all__ = ["Fit", "fit"]

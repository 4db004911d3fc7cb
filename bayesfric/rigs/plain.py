"""What a rig has when it says nothing of its own: no rules, no path, nothing beyond its trials."""

from collections.abc import Mapping
from typing import Any, Self

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from bayesfric.physics.compliant import Cable
from bayesfric.rigs.base import Predictive, Resting, Unsupported
from bayesfric.rigs.pulleys import PulleyTrials
from bayesfric.schemas import PointEstimate

__all__ = ["PlainTrials"]

Array = NDArray[np.float64]


class PlainTrials(PulleyTrials):
    """Steady trials all of which enter; see :class:`bayesfric.rigs.base.RigTrials`."""

    @property
    def excluded(self) -> Mapping[str, str] | None:
        """None: no rule keeps a trial from entering."""
        return None

    def moved(self) -> None:
        """Return None: all trials move, since the rig moves them."""

    def entering(self) -> Self:
        """Return all trials."""
        return self

    def next_trials(self, laws: Mapping[str, Any]) -> Self | None:
        """Return None: nobody lays out further trials."""
        del laws
        return None

    def quality(self) -> Mapping[str, Any]:
        """Return nothing."""
        return {}

    def paper_estimates(self) -> Mapping[str, PointEstimate]:
        """Return nothing: the paper takes its coefficients from a board of its own."""
        return {}

    def stretch_ratios(self, cable: Cable, theta: Mapping[str, Array]) -> Array | Unsupported:
        """Decline: at constant speed the stretch of the cable is constant."""
        del cable, theta
        return Unsupported("A steady trial does not ring: the stretch of its cable is constant.")

    def resting(self, conditions: pd.DataFrame) -> Resting | None:
        """Return None: the rig moves the cable whatever friction is."""
        del conditions
        return None

    def figures(self, view: Predictive) -> Mapping[str, xr.Dataset]:
        """Return nothing beyond the trials."""
        del view
        return {}

"""What a rig has when it says nothing of its own: no rules, no path, nothing beyond its trials."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Self, cast

import pandas as pd
import xarray as xr

from bayesfric.arrays import Array
from bayesfric.physics.cable import Cable
from bayesfric.rigs.base import Predictive, Resting, RigTrials, Unsupported
from bayesfric.rigs.pulleys import PulleyTrials
from bayesfric.schemas import PointEstimate


class PlainTrials(PulleyTrials):
    """Steady trials all of which enter; see :class:`bayesfric.rigs.base.RigTrials`."""

    @property
    def _own(self) -> RigTrials:
        """The trials with all that their rig says of them."""
        return cast(RigTrials, self)

    @property
    def slowest_speed_m_s(self) -> float:
        """The least speed of a trial; infinite where nobody says [m/s]."""
        if "velocity_m_s" not in self._own.table:
            return float("inf")
        return float(self._own.table["velocity_m_s"].abs().min())

    def levels(self, name: str) -> int:
        """Return how many values a column takes; ``tension`` is the nominal one, or the load."""
        if name == "tension":
            name = "tension_n" if "tension_n" in self._own.table else self._own.loads[0]
        return int(self._own.table[name].nunique())

    def select(self, keep: "pd.Series[bool]") -> Self | None:
        """Return the trials of a mask over the table; None without any."""
        table = self._own.table[keep].reset_index(drop=True)
        trials: Self = replace(cast(Any, self), table=table)  # each rig's trials are a dataclass
        return trials if len(table) else None

    @property
    def excluded(self) -> Mapping[str, str] | None:
        """None: no rule keeps a trial from entering."""
        return None

    def moved(self) -> None:
        """Return None: all trials move, since the rig moves them."""

    def entering(self) -> Self:
        """Return all trials."""
        return self

    def planned(self, laws: Mapping[str, Any]) -> Self | None:
        """Return all trials: readings are linear, so that what they tell rests on conditions."""
        del laws
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

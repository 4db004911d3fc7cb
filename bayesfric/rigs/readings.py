"""Trials with a single reading of friction, whose conditions a rig defines."""

from abc import abstractmethod
from collections.abc import Mapping, Sequence

import xarray as xr

from bayesfric.analysis import Analysis
from bayesfric.effects.candidates import Candidate
from bayesfric.effects.terms import ActiveEffect
from bayesfric.observation.exact import ExactLikelihood
from bayesfric.observation.points import LinearReadings
from bayesfric.observation.readings import Readings, ReadingsModel
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.laws import BASELINES, FrictionLaw
from bayesfric.rigs.base import CONDITION, Predictive, RigTrials
from bayesfric.rigs.residuals import beside_predicted


class ReadingTrials(RigTrials):
    """Trials with one reading of friction each; see :class:`bayesfric.rigs.base.RigTrials`.

    Attributes
    ----------
    law : FrictionLaw
        The law around which a diagnosis linearises.
    """

    law: FrictionLaw = BASELINES["paper"]

    @abstractmethod
    def readings(self, law: FrictionLaw) -> Readings:
        """Return the readings under a friction law."""

    @property
    def recorded_columns(self) -> tuple[str, ...]:
        """The recorded columns of a condition, for figures."""
        names = ("pulley_size", *CONDITION, "velocity_m_s")
        return tuple(name for name in names if name in self.table)

    def linear(
        self, laws: Mapping[str, Coefficients], acting: Sequence[tuple[Candidate, float]] = ()
    ) -> LinearReadings:
        """Return the readings as rows of a linear model; acting effects do not change them."""
        del acting
        return self.readings(self.law).linear(laws)

    def likelihood(
        self,
        analysis: Analysis,
        law: FrictionLaw = BASELINES["paper"],
        effects: Sequence[ActiveEffect] = (),
    ) -> ExactLikelihood:
        """Return the likelihood of the readings under a law with the effects that it supports."""
        supported = [effect for effect in effects if self.supports(effect.effect) is None]
        return ExactLikelihood(ReadingsModel(self.readings(law), analysis, supported))

    def predicted(self, view: Predictive) -> xr.Dataset:
        """Return the measured friction, and that predicted for a new reading."""
        assert isinstance(view.likelihood, ExactLikelihood)
        kept = ("setup", "friction_n", *self.recorded_columns)
        observed = {name: self.table[name].to_numpy() for name in kept}
        law = view.likelihood.law(view.named)
        return beside_predicted(
            self.rig.words.trial, self.table, observed, law, self.recorded, view
        )

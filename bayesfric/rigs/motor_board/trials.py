"""The runs of the motor board that are used in a fit or a diagnosis."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import pandas as pd
import xarray as xr

from bayesfric.analysis import Analysis
from bayesfric.effects import Effect
from bayesfric.effects.candidates import Candidate
from bayesfric.effects.terms import ActiveEffect
from bayesfric.observation.exact import ExactLikelihood
from bayesfric.observation.points import LinearReadings
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.laws import BASELINES, FrictionLaw
from bayesfric.recording.tables import Motor, RigConstants
from bayesfric.rigs.base import Predictive, Rig, RigTrials, Unsupported
from bayesfric.rigs.motor_board.likelihood import MotorModel
from bayesfric.rigs.motor_board.linear import motor_rows
from bayesfric.rigs.motor_board.places import RunPlaces
from bayesfric.rigs.motor_board.predictions import runs as runs_dataset


@dataclass(frozen=True)
class MotorRuns(RigTrials):
    """Runs that are used.

    Parameters
    ----------
    rig : Rig
        The kind of rig.
    constants : RigConstants
        Constants of the board.
    motor : Motor
        Runs, and measurements of the idle motor.
    recorded : DataFrame
        All recorded runs; their identifiers are in ``trial``.
    law : FrictionLaw
        Law around which a diagnosis linearises.
    loads : tuple of str
        Columns that define a condition, together with size, number and wrap angle.
    """

    rig: Rig
    constants: RigConstants
    motor: Motor
    recorded: pd.DataFrame
    law: FrictionLaw = BASELINES["paper"]
    loads: tuple[str, ...] = ("hanging_mass_kg",)

    @cached_property
    def table(self) -> pd.DataFrame:
        """One row for each run; its identifier is ``trial``."""
        return _by_trial(self.motor.runs)

    def select(self, keep: "pd.Series[bool]") -> "MotorRuns | None":
        """Return the runs that a mask over the table selects; None if it selects none."""
        runs = self.motor.runs[keep].reset_index(drop=True)
        return replace(self, motor=Motor(runs, self.motor.idle)) if len(runs) else None

    def supports(self, effect: Effect) -> Unsupported | None:
        """Return why the likelihood cannot contain an effect; None if it can."""
        return RunPlaces(self.motor.runs, self.constants).supports(effect)

    def linear(
        self, laws: Mapping[str, Coefficients], acting: Sequence[tuple[Candidate, float]] = ()
    ) -> LinearReadings:
        """Return the currents as rows of a linear model."""
        del acting  # a steady run has no start of motion
        return motor_rows(self.motor, self.constants, laws, self.law)

    def likelihood(
        self,
        analysis: Analysis,
        law: FrictionLaw = BASELINES["paper"],
        effects: Sequence[ActiveEffect] = (),
    ) -> ExactLikelihood:
        """Return the density of the currents."""
        return ExactLikelihood(MotorModel(self.motor, self.constants, analysis, law, effects))

    def quality(self) -> Mapping[str, Any]:
        """Return the number of runs."""
        return {"motor_runs": len(self.motor.runs)}

    def predicted(self, view: Predictive) -> xr.Dataset:
        """Return observed friction, and predicted friction of a new run on a new assembly."""
        assert isinstance(view.likelihood, ExactLikelihood)
        assert isinstance(view.likelihood.model, MotorModel)
        return runs_dataset(view.likelihood.model, self.recorded, view)


def _by_trial(runs: pd.DataFrame) -> pd.DataFrame:
    return runs.rename(columns={"run": "trial"})

"""Runs of the motor board that enter, and what kind of rig it is."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bayesfric.analysis import Analysis
from bayesfric.effects import Effect
from bayesfric.effects.terms import ActiveEffect
from bayesfric.physics.compliant import Cable
from bayesfric.physics.laws import BASELINES, Baseline
from bayesfric.recording.tables import Motor, Recording, RigConstants
from bayesfric.rigs.base import Motion, Unsupported, Words
from bayesfric.rigs.motor_board.likelihood import MotorLikelihood
from bayesfric.rigs.motor_board.places import RunPlaces

__all__ = ["RIG", "MotorBoard", "MotorRuns"]

Array = NDArray[np.float64]
WORDS = Words("motor board", "run", "runs")


@dataclass(frozen=True)
class MotorBoard:
    """A board on which a motor winds the cable at constant speed."""

    name: str = "motor"
    motion: Motion = "steady"
    words: Words = WORDS
    tables: tuple[str, ...] = ("motor_runs.csv", "motor_idle.csv")

    def trials(self, recording: Recording, *, exclude: bool = True) -> "MotorRuns | None":
        """Return all runs: no rule keeps one out."""
        del exclude
        if recording.motor is None:
            return None
        return MotorRuns(recording.rig, recording.motor, recording.motor)


RIG = MotorBoard()


@dataclass(frozen=True)
class MotorRuns:
    """Runs that enter.

    Parameters
    ----------
    constants : RigConstants
        The board.
    motor : Motor
        Runs and idle measurements.
    recorded : Motor
        All runs as recorded.
    """

    constants: RigConstants
    motor: Motor
    recorded: Motor
    rig: MotorBoard = RIG
    loads: tuple[str, ...] = ("hanging_mass_kg",)

    @property
    def table(self) -> pd.DataFrame:
        """One row a run; its id is ``trial``."""
        return self.motor.runs.rename(columns={"run": "trial"})

    @property
    def slowest_speed_m_s(self) -> float:
        """The least speed of a run [m/s]."""
        return float(self.motor.runs["velocity_m_s"].abs().min())

    def levels(self, name: str) -> int:
        """Return how many values a column takes; ``tension`` is the hanging mass."""
        column = "hanging_mass_kg" if name == "tension" else name
        return int(self.motor.runs[column].nunique())

    def select(self, keep: "pd.Series[bool]") -> "MotorRuns | None":
        """Return the runs of a mask over the table; None without any."""
        runs = self.motor.runs[keep].reset_index(drop=True)
        return replace(self, motor=Motor(runs, self.motor.idle)) if len(runs) else None

    def supports(self, effect: Effect) -> Unsupported | None:
        """Return why an effect cannot enter the likelihood; None where it can."""
        return RunPlaces(self.motor.runs, self.constants).supports(effect)

    def likelihood(
        self,
        analysis: Analysis,
        law: Baseline = BASELINES["paper"],
        effects: Sequence[ActiveEffect] = (),
    ) -> MotorLikelihood:
        """Return the density of the currents."""
        return MotorLikelihood(self.motor, self.constants, analysis, law, effects)

    def stretch_ratios(self, cable: Cable, theta: Mapping[str, Array]) -> Array | Unsupported:
        """Decline: at constant speed the stretch of the cable is constant."""
        del cable, theta
        return Unsupported("At constant speed the stretch of the cable does not change.")

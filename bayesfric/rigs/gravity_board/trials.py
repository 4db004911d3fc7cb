"""Trials of the gravity board that enter, and what kind of rig it is."""

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
from bayesfric.recording.tables import Gravity, Recording, RigConstants
from bayesfric.rigs.base import Motion, Unsupported, Words
from bayesfric.rigs.gravity_board.likelihood import GravityLikelihood
from bayesfric.rigs.gravity_board.places import TrialPlaces
from bayesfric.rigs.gravity_board.screening import Screened, screen_trials
from bayesfric.rigs.gravity_board.stretch import friction_ratios
from bayesfric.rigs.gravity_board.trial_motion import pilot_fits

__all__ = ["RIG", "GravityBoard", "GravityTrials"]

Array = NDArray[np.float64]
WORDS = Words("gravity board", "trial", "trials")


@dataclass(frozen=True)
class GravityBoard:
    """A board on which a weight falls and lifts another over n pulleys."""

    name: str = "gravity"
    motion: Motion = "accelerated"
    words: Words = WORDS
    tables: tuple[str, ...] = ("gravity_trials.csv", "gravity_events.csv")

    def trials(self, recording: Recording, *, exclude: bool = True) -> "GravityTrials | None":
        """Return the trials that enter by the rules of :mod:`.screening`."""
        if recording.gravity is None:
            return None
        screened = screen_trials(recording.gravity, recording.rig, exclude=exclude)
        return GravityTrials(recording.rig, screened.gravity, screened, recording.gravity)


RIG = GravityBoard()


@dataclass(frozen=True)
class GravityTrials:
    """Trials that enter, those of an assembly adjacent.

    Parameters
    ----------
    constants : RigConstants
        The board.
    gravity : Gravity
        Trials and their repaired events.
    screened : Screened
        How they were chosen.
    recorded : Gravity
        All trials as recorded.
    """

    constants: RigConstants
    gravity: Gravity
    screened: Screened
    recorded: Gravity
    rig: GravityBoard = RIG
    loads: tuple[str, ...] = ("mass_drive_kg", "mass_load_kg")

    @property
    def table(self) -> pd.DataFrame:
        """One row a trial."""
        return self.gravity.trials

    @property
    def slowest_speed_m_s(self) -> float:
        """The least speed at any event; infinite without events [m/s]."""
        events, trials = self.gravity.events, self.gravity.trials
        if events.empty:
            return float("inf")
        with_events = trials["trial"].isin(events["trial"])
        return float(pilot_fits(events, trials["trial"][with_events]).least_speed.min())

    def levels(self, name: str) -> int:
        """Return how many values a column takes; ``tension`` is the sum of both masses."""
        trials = self.gravity.trials
        if name == "tension":
            return int((trials["mass_drive_kg"] + trials["mass_load_kg"]).round(2).nunique())
        return int(trials[name].nunique())

    def select(self, keep: "pd.Series[bool]") -> "GravityTrials | None":
        """Return the trials of a mask over the table; None without any."""
        trials = self.gravity.trials[keep].reset_index(drop=True)
        events = self.gravity.events
        events = events[events["trial"].isin(trials["trial"])].reset_index(drop=True)
        return replace(self, gravity=Gravity(trials, events)) if len(trials) else None

    def supports(self, effect: Effect) -> Unsupported | None:
        """Return why an effect cannot enter the likelihood; None where it can."""
        return TrialPlaces(self.gravity, self.constants).supports(effect)

    def likelihood(
        self,
        analysis: Analysis,
        law: Baseline = BASELINES["paper"],
        effects: Sequence[ActiveEffect] = (),
    ) -> GravityLikelihood:
        """Return the density of the event times."""
        return GravityLikelihood(self.gravity, self.constants, analysis, law, effects)

    def stretch_ratios(self, cable: Cable, theta: Mapping[str, Array]) -> Array | Unsupported:
        """Return friction of model (3) over that of model (4), where a trial has events."""
        trials, events = self.gravity.trials, self.gravity.events
        seen = trials["trial"].isin(events["trial"])
        if not seen.any():
            return Unsupported("No trial has Hall events, which would show a stretch.")
        with_events = Gravity(trials[seen].reset_index(drop=True), events)
        sigma_x, sigma_t = (float(np.median(theta[name])) for name in ("sigma_x", "sigma_t"))
        return friction_ratios(with_events, self.constants, cable, sigma_x, sigma_t)

"""Trials of the gravity board that enter, and what kind of rig it is."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import pandas as pd

from bayesfric.analysis import Analysis
from bayesfric.effects.candidates import Candidate
from bayesfric.effects.terms import ActiveEffect
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.laws import BASELINES, Baseline
from bayesfric.recording.tables import Gravity, Recording, RigConstants
from bayesfric.rigs.base import Motion, Words
from bayesfric.rigs.gravity_board.likelihood import GravityLikelihood
from bayesfric.rigs.gravity_board.measured_motion import MeasuredMotion, measured_motion
from bayesfric.rigs.gravity_board.next_trials import lay_out
from bayesfric.rigs.gravity_board.rows import GravityRows
from bayesfric.rigs.gravity_board.screening import Screened, screen_trials
from bayesfric.rigs.gravity_board.trial_motion import pilot_fits

__all__ = ["RIG", "GravityBoard", "GravityTrials"]


MANY = 0.1  # of the trials, whose sensors disagree, from which on it is the rig's doing
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

    @cached_property
    def measured(self) -> MeasuredMotion:
        """What events say of the motion, whatever the law is."""
        return measured_motion(self.gravity, self.constants)

    def linear(
        self, laws: Mapping[str, Coefficients], acting: Sequence[tuple[Candidate, float]] = ()
    ) -> GravityRows:
        """Return the events as rows of a linear model."""
        return GravityRows(self.gravity, self.constants, laws, self.measured, acting)

    def entering(self) -> "GravityTrials":
        """Return the trials that enter a diagnosis.

        Where the sensors of many trials disagree, it is no fault of a trial, but of the rig,
        and what the diagnosis is to find: these trials stay.
        """
        excluded = self.screened.excluded
        disagreeing = [trial for trial, rule in excluded.items() if rule == "sensors-disagree"]
        if len(disagreeing) <= MANY * len(self.recorded.trials):
            return self
        screened = screen_trials(self.recorded, self.constants, exclude=False)
        whole = replace(self, gravity=screened.gravity, screened=screened)
        kept = whole.select(~whole.table["trial"].isin(set(excluded) - set(disagreeing)))
        assert kept is not None
        return kept

    def next_trials(self, laws: Mapping[str, Coefficients]) -> "GravityTrials | None":
        """Return a trial at every feasible condition; see :mod:`.next_trials`."""
        laid = lay_out(self.gravity.trials, self.constants, laws)
        return None if laid is None else replace(self, gravity=laid)

    def likelihood(
        self,
        analysis: Analysis,
        law: Baseline = BASELINES["paper"],
        effects: Sequence[ActiveEffect] = (),
    ) -> GravityLikelihood:
        """Return the density of the event times."""
        return GravityLikelihood(self.gravity, self.constants, analysis, law, effects)

"""The gravity board as a rig: its trials, its simulation, and remarks before any fit."""

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from bayesfric.errors import Fault, InputError
from bayesfric.recording.csv_text import LISTED, with_rest
from bayesfric.recording.tables import Gravity, Recording, RigConstants
from bayesfric.rigs.base import Rig, Words
from bayesfric.rigs.gravity_board.screening import RULES, Screened, screen_trials
from bayesfric.rigs.gravity_board.sensor_clocks import clock_faults

if TYPE_CHECKING:
    from bayesfric.effects import Effect
    from bayesfric.rigs.changes import Change
    from bayesfric.rigs.gravity_board.trials import GravityTrials
    from bayesfric.rigs.own_design import Simulated
    from bayesfric.rigs.protocols import Protocol as Design
    from bayesfric.rigs.truth import Truth

STREAMS = (0, 1, 2, 3, 5)  # random streams of a seed: order, scatter, sensors, noise, phases
WORDS = Words("gravity board", "trial", "trials", regime="accelerated", paper=True)


@dataclass(frozen=True)
class GravityBoard(Rig):
    """A board on which a weight falls and lifts another over n pulleys."""

    name: str = "gravity"
    words: Words = WORDS
    tables: tuple[str, ...] = ("gravity_trials.csv", "gravity_events.csv")

    def trials(self, recording: Recording, *, exclude: bool = True) -> "GravityTrials | None":
        """Return the trials that the rules of :mod:`.screening` do not exclude.

        Raises
        ------
        InputError
            The clocks of the two sensors differ by more than a cable explains.
        """
        if recording.gravity is None:
            return None
        from bayesfric.rigs.gravity_board.trials import GravityTrials

        screened = _screened(recording, exclude)
        if faults := clock_faults(screened.clocks):
            raise InputError(faults)
        return GravityTrials(
            self, recording.rig, screened.gravity, screened, recording.gravity, screened.at_rest
        )

    def remarks(self, recording: Recording) -> tuple[tuple[str, str], ...]:
        """Return the difference of the clocks of the two sensors, in words."""
        if recording.gravity is None:
            return ()
        clocks = _screened(recording, exclude=True).clocks
        if faults := clock_faults(clocks):
            raise InputError(faults)
        text = clocks.described
        return () if text is None else (("sensor clocks", text),)

    def left_out(self, recording: Recording) -> list[Fault]:
        """Return the trials that the rules of :mod:`.screening` exclude, each with its rule."""
        if recording.gravity is None:
            return []
        excluded = _screened(recording, exclude=True).excluded
        faults = [
            Fault("gravity_trials.csv", f"a trial that enters; {rule}: {RULES[rule]}", None, trial)
            for trial, rule in excluded.items()
        ]
        return with_rest(faults[:LISTED], len(faults[LISTED:]))

    def change(
        self, effect: "Effect", design: "Design", constants: RigConstants, truth: "Truth"
    ) -> "Change | None":
        """Return a function that computes an effect's change of friction; None if it cannot act."""
        from bayesfric.rigs.gravity_board.strength import change_of_readings, change_of_trials

        if effect.acts_on == "current":
            return None
        if effect.acts_on == "reading":
            return change_of_readings(design, constants, truth)
        return change_of_trials(design, constants, truth)

    def simulate(
        self, design: "Design", constants: RigConstants, truth: "Truth", seed: int
    ) -> "Simulated":
        """Return simulated trials and their events; see :mod:`.simulator`."""
        from bayesfric.rigs.gravity_board.simulator import draw_events, trials_in_random_order
        from bayesfric.rigs.own_design import Simulated

        streams = [np.random.default_rng(child) for child in np.random.SeedSequence(seed).spawn(7)]
        order, *rngs = (streams[place] for place in STREAMS)
        trials = trials_in_random_order(design, order)
        events, moved, stayed = draw_events(trials, constants, truth, *rngs)
        if stayed.any():
            trials["did_not_move"] = np.where(stayed, "true", "false")
        kept = trials[moved | stayed].reset_index(drop=True)
        stalled = tuple(trials.loc[~(moved | stayed), "trial"])
        return Simulated({"gravity": Gravity(kept, events)}, len(kept), stalled)


RIG = GravityBoard()


@lru_cache(maxsize=2)
def _screened(recording: Recording, exclude: bool) -> Screened:
    """Return the screened trials of a recording, which are computed once."""
    assert recording.gravity is not None
    return screen_trials(recording.gravity, recording.rig, exclude=exclude)

"""The motor board as a rig: its runs and its simulation."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from bayesfric.recording.tables import Recording, RigConstants
from bayesfric.rigs.base import Rig, Words

if TYPE_CHECKING:
    from bayesfric.effects import Effect
    from bayesfric.rigs.changes import Change
    from bayesfric.rigs.motor_board.trials import MotorRuns
    from bayesfric.rigs.own_design import Simulated
    from bayesfric.rigs.protocols import Protocol as Design
    from bayesfric.rigs.truth import Truth

STREAMS = (4, 6)  # random streams of a seed: runs, and phases of effects on them
WORDS = Words("motor board", "run", "runs", paper=True)


@dataclass(frozen=True)
class MotorBoard(Rig):
    """A board on which a motor winds the cable at constant speed."""

    name: str = "motor"
    words: Words = WORDS
    tables: tuple[str, ...] = ("motor_runs.csv", "motor_idle.csv")

    def trials(self, recording: Recording, *, exclude: bool = True) -> "MotorRuns | None":
        """Return all runs."""
        del exclude  # no rule excludes runs
        if recording.motor is None:
            return None
        from bayesfric.rigs.motor_board.trials import MotorRuns

        motor = recording.motor
        return MotorRuns(self, recording.rig, motor, motor.runs.rename(columns={"run": "trial"}))

    def change(
        self, effect: "Effect", design: "Design", constants: RigConstants, truth: "Truth"
    ) -> "Change | None":
        """Return a function that computes an effect's change of friction; None if it cannot act."""
        from bayesfric.rigs.motor_board.strength import change_of_runs

        del design
        return None if effect.acts_on == "reading" else change_of_runs(constants, truth)

    def simulate(
        self, design: "Design", constants: RigConstants, truth: "Truth", seed: int
    ) -> "Simulated":
        """Return simulated runs and measurements of the idle motor; see :mod:`.simulator`."""
        from bayesfric.rigs.motor_board.simulator import simulate_motor
        from bayesfric.rigs.own_design import Simulated

        del design
        streams = [np.random.default_rng(child) for child in np.random.SeedSequence(seed).spawn(7)]
        motor = simulate_motor(constants, truth, *(streams[place] for place in STREAMS))
        return Simulated({"motor": motor}, len(motor.runs))


RIG = MotorBoard()

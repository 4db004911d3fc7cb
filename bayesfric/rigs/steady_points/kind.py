"""A bench of steady points as a rig: its points and its simulation."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from bayesfric.recording.tables import Recording
from bayesfric.rigs.base import Rig, Words

if TYPE_CHECKING:
    from bayesfric.rigs.own_design import OwnDesign
    from bayesfric.rigs.steady_points.trials import SteadyTrials

WORDS = Words(
    "bench",
    "point",
    "points",
    "The law of friction is c1 T + c2 at a load T, of which c2 alone is left where no load was "
    "recorded; of n pulleys of wrap angle θ it is n ((c1 + c3 (θ − 85°)) T + c2). A reading is "
    "the law's friction times 1 + η + ε, of its assembly and its own, both "
    "normal, and an error with the standard error that was recorded or, where there is none, "
    "with one that is estimated.",
)


@dataclass(frozen=True)
class SteadyPoints(Rig):
    """Any bench, joint or slide on which friction was measured in steady motion."""

    name: str = "steady-points"
    words: Words = WORDS
    tables: tuple[str, ...] = ("steady_friction.csv",)

    @property
    def own_design(self) -> "OwnDesign":
        """Design of a simulated bench with medium pulleys."""
        from bayesfric.rigs.steady_points.simulator import DESIGN

        return DESIGN

    def trials(self, recording: Recording, *, exclude: bool = True) -> "SteadyTrials | None":
        """Return all points."""
        del exclude  # no rule excludes points
        if recording.steady is None:
            return None
        from bayesfric.rigs.steady_points.bench import bench_of
        from bayesfric.rigs.steady_points.trials import SteadyTrials

        bench = bench_of(recording.steady, rotary=recording.rig.rotary)
        return SteadyTrials(self, bench, recording.steady.rename(columns={"run": "trial"}))


RIG = SteadyPoints()

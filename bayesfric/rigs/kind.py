"""What a kind of rig is called, and what it has when it says nothing of its own.

The kinds of rigs are light: what fits, predicts and simulates is loaded by the methods that need
it, so that a recording is described, and its faults are told, in a moment.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from bayesfric.errors import Fault
from bayesfric.recording.tables import Recording, RigConstants

if TYPE_CHECKING:
    from bayesfric.effects import Effect
    from bayesfric.rigs.changes import Change
    from bayesfric.rigs.own_design import OwnDesign, Simulated
    from bayesfric.rigs.protocols import Protocol as Design
    from bayesfric.rigs.truth import Truth

Regime = Literal["accelerated", "steady"]
"""Whether a trial gathers speed along a path, or is one measurement at one speed."""


@dataclass(frozen=True)
class Words:
    """What a rig and its parts are called in sentences.

    Parameters
    ----------
    rig : str
        As in ``gravity board``.
    trial, trials : str
        One of its measurements, and several.
    law : str
        What its law and its likelihood are, in sentences; nothing where they are the paper's.
    group, groups : str
        What trials of one value of ``setup`` are together, and several of these.
    regime : str
        How its trials move.
    paper : bool
        Whether it is one of the paper's own, which its protocols are for.
    thresholds : dataclass or None
        By which its log is read, where there are some: fields made by
        :func:`bayesfric.rules.rule`.
    """

    rig: str
    trial: str
    trials: str
    law: str = ""
    group: str = "assembly"
    groups: str = "assemblies"
    regime: Regime = "steady"
    paper: bool = False
    thresholds: Any = None


class PlainRig:
    """A rig that no protocol lays out; see :class:`bayesfric.rigs.base.Rig`."""

    @property
    def own_design(self) -> "OwnDesign | None":
        """None: a protocol lays it out, or nothing does."""
        return None

    def remarks(self, recording: Recording) -> tuple[tuple[str, str], ...]:
        """Return nothing."""
        del recording
        return ()

    def left_out(self, recording: Recording) -> Sequence[Fault]:
        """Return nothing: no rule keeps a trial from entering."""
        del recording
        return ()

    def change(
        self, effect: "Effect", design: "Design", constants: RigConstants, truth: "Truth"
    ) -> "Change | None":
        """Return None: protocols lay out the paper's boards alone."""
        del effect, design, constants, truth
        return None

    def simulate(
        self, design: "Design", constants: RigConstants, truth: "Truth", seed: int
    ) -> "Simulated":
        """Record nothing: protocols lay out the paper's boards alone."""
        del design, constants, truth, seed
        from bayesfric.rigs.own_design import Simulated

        return Simulated({}, 0)

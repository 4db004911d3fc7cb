"""The rig of a driven axis: its name, texts and tables, and remarks on a recording."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from bayesfric.errors import Fault
from bayesfric.observation.unsupported import Unsupported
from bayesfric.recording.joints import parted_by_joint
from bayesfric.recording.tables import Recording
from bayesfric.rigs.base import Rig, Words
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES

if TYPE_CHECKING:
    from bayesfric.rigs.own_design import OwnDesign
    from bayesfric.rigs.single_axis.trials import AxisRuns

WORDS = Words(
    "driven axis",
    "run",
    "runs",
    "The law is what every simulator of joints has: inertia times acceleration is the drive force "
    "less a constant offset and less Coulomb and viscous friction, which oppose the motion. "
    "Acceleration is never measured, and no difference of positions is taken: force "
    "and position are multiplied by a smooth test function over short windows in which the axis "
    "runs one way, and integrated by parts, so that each window gives a mean force. Windows are "
    "correlated by the errors of positions and forces, and by friction that varies along the path; "
    "friction scatters from run to run (τ) and from setup to setup (ω). The clocks of force "
    "and position may differ by a little (latency); the fit does not take that for friction.",
    "setup",
    "setups",
    "accelerated",
    thresholds=AXIS_RULES,
)


@dataclass(frozen=True)
class SingleAxis(Rig):
    """A mass or a joint that a single drive moves along or about one axis."""

    name: str = "single-axis"
    words: Words = WORDS
    tables: tuple[str, ...] = ("axis_runs.csv", "axis_samples.csv")

    @property
    def own_design(self) -> "OwnDesign":
        """The design of simulated recordings: a mass on a slide."""
        from bayesfric.rigs.single_axis.simulator import DESIGN

        return DESIGN

    def trials(self, recording: Recording, *, exclude: bool = True) -> "AxisRuns | None":
        """Return the runs in which the axis moves; `exclude` has no effect."""
        del exclude
        if recording.axis is None:
            return None
        from bayesfric.rigs.single_axis.enough import not_modelled
        from bayesfric.rigs.single_axis.trials import opened

        if not_modelled(recording.axis):
            return None
        return opened(self, recording.axis, recording.rig)

    def remarks(self, recording: Recording) -> tuple[tuple[str, str], ...]:
        """Return remarks on the servo of a log of commands."""
        if recording.axis is None:
            return ()
        from bayesfric.rigs.single_axis.servo import servo_of

        lines: list[tuple[str, str]] = []
        for joint, part in (parted_by_joint(recording) or {"": recording}).items():
            servo = None if part.axis is None else servo_of(part.axis, recording.rig)
            said = () if servo is None else servo.said(rotary=recording.rig.rotary)
            lines += [(f"servo {joint}".strip(), line) for line in said]
        return tuple(lines)

    def left_out(self, recording: Recording) -> list[Fault]:
        """Return the runs that are not used, and why; see :mod:`.enough`."""
        if recording.axis is None:
            return []
        from bayesfric.rigs.single_axis.enough import left_out, not_modelled
        from bayesfric.rigs.single_axis.entering import entering

        if parted := parted_by_joint(recording):
            return [
                replace(fault, column=f"{joint}, {fault.column}" if fault.column else joint)
                for joint, part in parted.items()
                for fault in self.left_out(part)
            ]
        if faults := not_modelled(recording.axis):
            return faults
        entered = entering(recording.axis, recording.rig)
        if isinstance(entered, Unsupported):
            return [Fault(self.tables[1], f"a run that can be used: {entered.reason}")]
        return left_out(recording.axis, recording.rig)


RIG = SingleAxis()

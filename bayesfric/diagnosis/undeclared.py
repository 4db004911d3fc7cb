"""Undeclared properties of a machine on which the result depends."""

from collections.abc import Collection, Iterator, Mapping

from bayesfric.effects import Effect
from bayesfric.recording.tables import RigConstants

COMMANDED = "commanded-force"
LIMITED = "limit"
BY_LOAD = frozenset({"load-friction", "load-quadratic", "load-stribeck"})


def undeclared(
    rig: RigConstants,
    verdict: str,
    other_joints: str | None,
    named: Collection[str],
    examined: Mapping[str, Effect],
    *,
    has_force: bool = True,
) -> Iterator[str]:
    """Yield a sentence for each undeclared property that could change the result.

    Parameters
    ----------
    rig : RigConstants
        The machine.
    verdict : str
        Verdict of the diagnosis.
    other_joints : str or None
        State of other joints; None without other joints.
    named : collection of str
        Effects that are causes, possible or considered.
    examined : mapping of str to Effect
        All examined effects.
    has_force : bool
        Whether a force was logged; if not, only the commands of a servo were.
    """
    if other_joints is None:
        return
    if has_force and rig.force_is in (None, "unknown"):
        names = [
            name
            for name in sorted({*named})
            if name in examined and examined[name].needs & {COMMANDED, LIMITED}
        ]
        if names:
            yield (
                "The kind of the logged force is not declared (rig.force_is): "
                f"{' and '.join(names)} can act on a force that was commanded, and not on one "
                "that was measured"
            )
    by_load = sorted(BY_LOAD.intersection(named))
    if by_load and "load-asymmetry" not in examined:
        yield (
            f"{' and '.join(by_load)} may act in one direction of the power only: a gear that "
            "loses more when driving than when driven back looks like an error of the force's "
            "gain, of inertia and of gravity. A load whose torque is known separates them"
        )
    if verdict == "unknown" and other_joints == "unknown" and rig.rotary:
        yield (
            "The motion of the machine's other joints is not declared (rig.other_joints): if they "
            "moved and are not in the log, their pull may be the unknown force"
        )

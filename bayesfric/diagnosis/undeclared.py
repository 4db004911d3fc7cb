"""What nobody said of a machine, where the answer hangs on it."""

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
) -> Iterator[str]:
    """Yield a sentence for each thing that nobody said and that would change the answer.

    Parameters
    ----------
    rig : RigConstants
        The machine.
    verdict : str
        Of the diagnosis.
    other_joints : str or None
        What other joints did; None where there are none.
    named : collection of str
        Effects that are causes, possible, or considered.
    examined : mapping of str to Effect
        All that were examined.
    """
    if other_joints is None:
        return
    if rig.force_is in (None, "unknown"):
        names = [
            name
            for name in sorted({*named})
            if name in examined and examined[name].needs & {COMMANDED, LIMITED}
        ]
        if names:
            yield (
                "Nobody says what kind of force was logged (rig.force_is): "
                f"{' and '.join(names)} can act on a force that was commanded, and not on one "
                "that was measured"
            )
    by_load = sorted(BY_LOAD.intersection(named))
    if by_load and "load-asymmetry" not in examined:
        yield (
            f"{' and '.join(by_load)} may be of one way of the power alone: what a gear loses more "
            "when driving than when driven back looks like an error of the force's gain, of "
            "inertia and of gravity. A load whose torque is known tells them apart"
        )
    if verdict == "unknown" and other_joints == "unknown" and rig.rotary:
        yield (
            "Nobody says what the machine's other joints did (rig.other_joints): their pull, if "
            "they moved and are not in the log, may be what is unknown"
        )

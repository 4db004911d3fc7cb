"""A diagnosis looked at before it is written: what breaks an invariant is no finding."""

from collections.abc import Sequence

from bayesfric.analysis import Analysis
from bayesfric.invariants import broken, check_record
from bayesfric.schemas import Cause, DiagnosisFile, Gap

__all__ = ["attention_of", "looked_at", "not_followed"]


def looked_at(summary: DiagnosisFile) -> DiagnosisFile:
    """Return a diagnosis with what must hold of it, and no verdict where something does not.

    A result that contradicts itself comes of a fault of the computation. It is told as that:
    the verdict is undecided, and its causes are those that were considered.
    """
    checks = check_record(summary.model_dump(mode="json", by_alias=True))
    faults = broken(checks)
    found = summary.model_copy(update={"checks": checks})
    if not faults:
        return found
    above = summary.gap.probability_above_practical
    details = "; ".join(check.detail or check.check for check in checks if not check.holds)
    considered = (*summary.causes, *summary.considered)
    return found.model_copy(
        update={
            "verdict": "undecided",
            "verdict_probability": max(above, 1 - above),
            "causes": (),
            "considered": considered,
            "considered_why": None if considered else "no effect was named",
            "sentence": f"The computation contradicts itself, so that nothing is concluded: "
            f"{details}.",
            "attention": (*summary.attention, *faults),
        }
    )


def attention_of(
    analysis: Analysis, gap: Gap, causes: Sequence[Cause], considered: Sequence[Cause]
) -> tuple[str, ...]:
    """Return, in sentences, each check that failed, and each setting that is not followed.

    Parameters
    ----------
    analysis : Analysis
        The settings.
    gap : Gap
        As it is stored.
    causes, considered : sequence of Cause
        Effects that are named, and those that held-out data contradict.
    """
    lines = list(not_followed(analysis))
    if considered:
        names = ", ".join(effect.effect for effect in considered)
        lines.append(f"Held-out data contradict {names}: they shrink by less than the model says.")
    if gap.floor_disagreement is not None:
        lines.append(f"Held-out data and the model disagree: {gap.floor_disagreement}.")
    for effect in causes:
        if not effect.plausible:
            name, number = next(iter(effect.parameters.items()))
            low, high = effect.plausible_range
            unit = "" if number.unit == "1" else f" {number.unit}"
            lines.append(
                f"{effect.effect} is larger or smaller than is plausible: {name} is "
                f"{number.q50:.3g}{unit}, outside of {low:.3g} to {high:.3g} "
                f"({effect.plausible_reference})."
            )
    return tuple(lines)


def not_followed(analysis: Analysis) -> tuple[str, ...]:
    """Return, in sentences, the settings that a diagnosis does not follow."""
    scatter = analysis.scatter
    return tuple(
        f"The scatter of {of} is taken as normal in a diagnosis: scatter.{key} = "
        f'"{value}" holds for fits and claims.'
        for key, value, of in (
            ("trial", scatter.trial, "trials"),
            ("assembly", scatter.assembly, "assemblies"),
        )
        if value != "normal"
    )

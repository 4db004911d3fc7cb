"""What a diagnosis says, in the words of the report."""

from typing import Literal, TypeAlias

from bayesfric.report.quantities import format_probability
from bayesfric.schemas import DiagnosisFile
from bayesfric.schemas.causes import Cause

VERDICTS = {
    "no-gap": "No gap",
    "named": "Cause named",
    "unseparated": "Causes not told apart",
    "unknown": "Cause unknown",
    "undecided": "Undecided",
}
Kind: TypeAlias = Literal["attention", "good", "info"]


def listed(effects: tuple[Cause, ...]) -> str:
    """Return effects, each with the probability that it acts."""
    return ", ".join(
        f"{effect.effect} ({format_probability(effect.inclusion_probability)})"
        for effect in effects
    )


def box(diagnosis: DiagnosisFile) -> Kind:
    """Return which box a verdict stands in: a green one only if nothing that it covers is open."""
    if diagnosis.verdict == "named":
        return "info"
    if diagnosis.verdict != "no-gap":
        return "attention"
    practical = diagnosis.practical_share * diagnosis.gap.friction_rms
    open_ = (
        diagnosis.gap.systematic.q50 > practical
        or diagnosis.remainder.significant
        or bool(diagnosis.causes)
    )
    return "info" if open_ else "good"


def has_gap(diagnosis: DiagnosisFile) -> bool:
    """Tell whether there is, or may be, a gap to place along axes."""
    return diagnosis.verdict != "no-gap"

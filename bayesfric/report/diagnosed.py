"""What a diagnosis says, in the words of the report."""

from typing import Literal, TypeAlias

from bayesfric.report.quantities import format_probability
from bayesfric.schemas import Cause, DiagnosisFile

VERDICTS = {
    "no-gap": "No gap",
    "named": "Named",
    "unseparated": "Not told apart",
    "unknown": "Unknown",
    "undecided": "Undecided",
}
Kind: TypeAlias = Literal["attention", "good", "info"]


def listed(effects: tuple[Cause, ...]) -> str:
    """Return effects, each with the probability that it acts."""
    return ", ".join(
        f"{one.effect} ({format_probability(one.inclusion_probability)})" for one in effects
    )


def box(found: DiagnosisFile) -> Kind:
    """Return which box a verdict stands in: a green one only if nothing that it covers is open."""
    if found.verdict == "named":
        return "info"
    if found.verdict != "no-gap":
        return "attention"
    practical = found.practical_share * found.gap.friction_rms
    open_ = (
        found.gap.systematic.q50 > practical or found.remainder.significant or bool(found.causes)
    )
    return "info" if open_ else "good"


def has_gap(found: DiagnosisFile) -> bool:
    """Tell whether there is, or may be, a gap to place along axes."""
    return found.verdict != "no-gap"

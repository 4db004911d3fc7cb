"""What a diagnosis says, whichever version of ``diagnosis.json`` said it."""

from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

from bayesfric.report.quantities import format_probability
from bayesfric.schemas import DiagnosisFile, Interval

__all__ = ["VERDICTS", "Acting", "acting", "also", "box", "has_gap", "strength"]

VERDICTS = {
    "no-gap": "No gap",
    "named": "Named",
    "unseparated": "Not told apart",
    "unknown": "Unknown",
    "undecided": "Undecided",
}
Kind: TypeAlias = Literal["attention", "good", "info"]


@dataclass(frozen=True)
class Acting:
    """How probable it is that an effect acts, and how strong it then is.

    Parameters
    ----------
    effect : str
        Its name.
    probability : float
        Over all hypotheses.
    strength : Interval or None
        Rms of its force over rms friction.
    """

    effect: str
    probability: float
    strength: Interval | None


def acting(found: DiagnosisFile) -> tuple[Acting, ...]:
    """Return every effect examined, the most probable first; none in files before `inclusion`."""
    entries: tuple[Any, ...] = getattr(found, "inclusion", ())
    return tuple(Acting(one.effect, one.probability, one.strength) for one in entries)


def also(found: DiagnosisFile, what: Literal["possible", "present"]) -> tuple[str, ...]:
    """Return effects that are no cause, with their probability: possible ones, or weak ones."""
    entries: tuple[Any, ...] = getattr(found, what, ())
    chance = {one.effect: one.probability for one in acting(found)}
    return tuple(
        f"{one.effect} ({format_probability(chance[one.effect])})"
        if one.effect in chance
        else str(one.effect)
        for one in entries
    )


def box(found: DiagnosisFile) -> Kind:
    """Return which box a verdict stands in: a green one only if nothing that it covers is open."""
    if found.verdict == "named":
        return "info"
    if found.verdict != "no-gap":
        return "attention"
    practical = found.practical_share * found.gap.friction_rms
    open_ = found.gap.systematic.q50 > practical or found.remainder.significant
    return "info" if open_ else "good"


def has_gap(found: DiagnosisFile) -> bool:
    """Tell whether there is, or may be, a gap to place along axes."""
    return found.verdict != "no-gap"


def strength(cause: Any) -> float | None:
    """Return the rms of a cause's force over that of friction, its median where it is uncertain."""
    value = getattr(cause, "strength", None)
    return value.q50 if isinstance(value, Interval) else value

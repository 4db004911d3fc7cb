"""What a diagnosis says, whichever version of ``diagnosis.json`` said it."""

from dataclasses import dataclass
from typing import Any, Literal

from bayesfric.report.quantities import format_probability
from bayesfric.schemas import DiagnosisFile, Interval

__all__ = ["KINDS", "VERDICTS", "Acting", "acting", "also", "has_gap", "strength"]

VERDICTS = {
    "no-gap": "No gap",
    "named": "Named",
    "unseparated": "Not told apart",
    "unknown": "Unknown",
    "undecided": "Undecided",
}
KINDS: dict[str, Literal["attention", "good", "info"]] = {
    "no-gap": "good",
    "named": "info",
    "unseparated": "attention",
    "unknown": "attention",
    "undecided": "attention",
}


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


def has_gap(found: DiagnosisFile) -> bool:
    """Tell whether there is, or may be, a gap to place along axes."""
    return found.verdict != "no-gap"


def strength(cause: Any) -> float | None:
    """Return the rms of a cause's force over that of friction, its median where it is uncertain."""
    value = getattr(cause, "strength", None)
    return value.q50 if isinstance(value, Interval) else value

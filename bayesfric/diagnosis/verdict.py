"""The rules of the verdict."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from bayesfric.diagnosis.classes import Classes
from bayesfric.diagnosis_rules import RULES
from bayesfric.effects import Effect
from bayesfric.hypothesis import UNKNOWN, Hypothesis
from bayesfric.probabilities import total
from bayesfric.schemas.causes import Unseparated

Verdict = Literal["no-gap", "named", "unseparated", "unknown", "undecided"]


@dataclass(frozen=True)
class KnownEffect:
    """Probability and strength of one effect.

    Parameters
    ----------
    effect : str
        Its name.
    probability : float
        Posterior probability that it acts.
    above_practical : float
        Probability that its own force is above the practical share.
    strength : float
        Posterior median, if it acts, of its rms force over rms friction.
    measuring : bool
        Whether it is an error of a sensor, a clock or a constant of the drive.
    """

    effect: str
    probability: float
    above_practical: float
    strength: float
    measuring: bool = False


def sort_effects(
    effects_known: Sequence[KnownEffect], above: float = 1.0
) -> tuple[list[str], list[str], list[str]]:
    """Return the causes, the effects that are present but too weak, and the possible effects.

    A cause acts with probability of at least 0.9, and its force exceeds the practical share
    with probability of at least 0.5. An error of measuring is a cause if the data feel it,
    unless the gap is certainly small: then it is present.

    Parameters
    ----------
    effects_known : sequence of KnownEffect
        Effects.
    above : float
        Probability that the gap is at least of practical size.
    """
    causes: list[str] = []
    present: list[str] = []
    possible: list[str] = []
    for effect in effects_known:
        matters = effect.above_practical >= RULES.likely
        if effect.measuring:
            matters = effect.strength >= RULES.felt and 1 - above < RULES.sure
        if effect.probability >= RULES.sure:
            (causes if matters else present).append(effect.effect)
        elif effect.probability >= RULES.possible:
            possible.append(effect.effect)
    return causes, present, possible


def decide(
    chances: Mapping[Hypothesis, float],
    causes: Sequence[KnownEffect],
    above: float,
    together: Sequence[Sequence[str]],
    *,
    none_before: float = RULES.likely,
    shown: bool = True,
) -> tuple[Verdict, float]:
    """Return the verdict and its probability.

    Parameters
    ----------
    chances : mapping of Hypothesis to float
        Posterior probabilities of hypotheses.
    causes : sequence of KnownEffect
        Effects that are causes.
    above : float
        Probability that the gap is at least of practical size.
    together : sequence of sequence of str
        Sets of effects of which one acts.
    none_before : float
        Prior probability of no effect, which uninformative data do not change.
    shown : bool
        Whether the data could have shown a gap.
    """
    if 1 - above >= RULES.sure:
        if shown:
            return "no-gap", 1 - above
        return "undecided", max(none_before, 1 - none_before)
    unknown = chances.get(UNKNOWN, 0.0)
    if unknown >= RULES.likely:
        return "unknown", unknown
    if above >= RULES.sure and causes:
        names = {cause.effect for cause in causes}
        return "named", total(p for acting, p in chances.items() if names <= acting)
    if above >= RULES.sure and together:
        rivals = {name for exclusive in together for name in exclusive}
        return "unseparated", total(p for acting, p in chances.items() if rivals & acting)
    return "undecided", max(above, 1 - above)


def sets_of_one(
    chances: Mapping[Hypothesis, float], effects_known: Sequence[KnownEffect], causes: Sequence[str]
) -> tuple[tuple[str, ...], ...]:
    """Return sets of effects of which one acts with probability 0.9, although no single one does.

    A set grows from the likeliest rivals until it reaches this probability.
    """
    rivals = [
        effect.effect
        for effect in effects_known
        if effect.effect not in causes and effect.probability < RULES.sure
    ]
    chosen: list[str] = []
    for name in rivals[:6]:
        chosen.append(name)
        either = total(p for acting, p in chances.items() if acting & set(chosen))
        if len(chosen) > 1 and either >= RULES.sure:
            return (tuple(chosen),)
    return ()


def unseparated_of(classes: Classes, together: Sequence[Sequence[str]]) -> tuple[Unseparated, ...]:
    """Return effects that are identical on this rig, and rivals that these data leave open."""
    unseparated = [
        Unseparated(effects=members, reason="identical-on-this-rig")
        for members in classes.members
        if len(members) > 1
    ]
    unseparated += [
        Unseparated(effects=tuple(effects), reason="these-data") for effects in together
    ]
    return tuple(unseparated)


def measures(effect: Effect) -> bool:
    """Return whether an effect is an error of a sensor, a clock or a constant of the drive."""
    return effect.acts_on in ("reading", "current")

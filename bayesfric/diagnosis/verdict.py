"""The verdict, by the rules of the contract."""

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
    """What is known of one effect.

    Parameters
    ----------
    effect : str
        Its name.
    probability : float
        That it acts, over all hypotheses.
    above_practical : float
        Probability that its own force is above the practical share.
    strength : float
        Its median, if it acts; rms of its force over rms friction.
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
    """Return the causes, those present but too weak to matter, and those that are possible.

    A cause acts with probability 0.9 at least, and its force is above the practical share
    with 0.5 at least. An error of measuring is a cause wherever it is felt and a gap may be
    there: where the gap is surely small it has caused none, and is present.

    Parameters
    ----------
    effects_known : sequence of KnownEffect
        Effects.
    above : float
        Probability that the gap is practical or more.
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
        Probability that the gap is practical or more.
    together : sequence of sequence of str
        Sets of effects of which one acts.
    none_before : float
        Prior probability that nothing acts, of which data that can show nothing leave all.
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
    """Return sets of effects of which one acts with probability 0.9, and none does alone.

    The set grows from the likeliest rivals until one of it surely acts.
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
    """Return what is identical on this rig, and what these data leave open."""
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

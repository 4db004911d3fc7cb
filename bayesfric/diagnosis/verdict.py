"""The verdict, by the rules of the contract, and in a sentence."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from bayesfric.diagnosis.classes import Classes
from bayesfric.effects import Effect
from bayesfric.probabilities import stated
from bayesfric.schemas import Axis, Cause, Gap, Interval, Unseparated

__all__ = ["Known", "Verdict", "decide", "sentence_of", "sort_effects", "unseparated_of"]

Verdict = Literal["no-gap", "named", "unseparated", "unknown", "undecided"]
HALF, SURE, POSSIBLE = 0.5, 0.9, 0.1
ALL_BUT = 0.999
FELT = 0.003  # of friction: an error of readings or of a current below it is not named
LEAST = 0.001  # of friction, below which a gap has no figure


@dataclass(frozen=True)
class Known:
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


def sort_effects(known: Sequence[Known]) -> tuple[list[str], list[str], list[str]]:
    """Return the causes, those present but too weak to matter, and those that are possible.

    A cause acts with probability 0.9 at least, and its force is above the practical share
    with 0.5 at least; an error of measuring counts wherever it is felt.
    """
    causes: list[str] = []
    present: list[str] = []
    possible: list[str] = []
    for one in known:
        matters = one.above_practical >= HALF
        if one.measuring:
            matters = one.strength >= FELT
        if one.probability >= SURE:
            (causes if matters else present).append(one.effect)
        elif one.probability >= POSSIBLE:
            possible.append(one.effect)
    return causes, present, possible


def decide(
    chances: Mapping[str, float],
    causes: Sequence[Known],
    above: float,
    together: Sequence[Sequence[str]],
) -> tuple[Verdict, float]:
    """Return the verdict and its probability.

    Parameters
    ----------
    chances : mapping of str to float
        Posterior probabilities of hypotheses.
    causes : sequence of Known
        Effects that are causes.
    above : float
        Probability that the gap is practical or more.
    together : sequence of sequence of str
        Sets of effects of which one acts.
    """
    unknown = chances.get("unknown", 0.0)
    if unknown >= HALF:
        return "unknown", unknown
    measuring = [one for one in causes if one.measuring]
    if causes and (above >= SURE or measuring):
        names = {one.effect for one in causes}
        every = sum(p for name, p in chances.items() if names <= set(name.split("+")))
        return "named", float(min(every, 1.0))
    if above >= SURE and together:
        acting = {name for one in together for name in one}
        some = sum(p for name, p in chances.items() if acting & set(name.split("+")))
        return "unseparated", float(min(some, 1.0))
    if 1 - above >= SURE:
        return "no-gap", float(1 - above)
    return "undecided", float(max(above, 1 - above))


def sets_of_one(
    chances: Mapping[str, float], known: Sequence[Known], causes: Sequence[str]
) -> tuple[tuple[str, ...], ...]:
    """Return sets of effects of which one acts with probability 0.9, and none does alone.

    The set grows from the likeliest rivals until one of it surely acts.
    """
    rivals = [one.effect for one in known if one.effect not in causes and one.probability < SURE]
    chosen: list[str] = []
    for name in rivals[:6]:
        chosen.append(name)
        either = sum(p for h, p in chances.items() if set(h.split("+")) & set(chosen))
        if len(chosen) > 1 and either >= SURE:
            return (tuple(chosen),)
    return ()


def unseparated_of(classes: Classes, together: Sequence[Sequence[str]]) -> tuple[Unseparated, ...]:
    """Return what is identical on this rig, and what these data leave open."""
    found = [
        Unseparated(effects=members, reason="identical-on-this-rig")
        for members in classes.members
        if len(members) > 1
    ]
    found += [Unseparated(effects=tuple(one), reason="these-data") for one in together]
    return tuple(found)


def measures(effect: Effect) -> bool:
    """Return whether an effect is an error of a sensor, a clock or a constant of the drive."""
    return effect.acts_on in ("reading", "current")


def sentence_of(
    verdict: Verdict,
    chance: float,
    causes: Sequence[Cause],
    gap: Gap,
    where: Sequence[Axis],
    unseparated: Sequence[Unseparated],
    share: float,
    weak: Sequence[Cause] = (),
) -> str:
    """Return the verdict in words: one thing, and the probability of that.

    Parameters
    ----------
    verdict, chance
        As of :func:`decide`.
    causes, gap, where, unseparated
        As they are stored.
    share : float
        The practical share of friction.
    weak : sequence of Cause
        Effects that act, and are each less than that share.
    """
    friction = gap.friction_rms
    size = f"less than {LEAST:.1%} of friction"
    if gap.systematic.q50 >= LEAST * friction:
        part = gap.systematic.q50 / friction
        size = f"{gap.systematic.q50:.3g} {gap.unit} rms, {part:.1%} of friction"
    acting = _acting(causes, unseparated)
    place = _lies_along(where) if gap.systematic.q50 >= LEAST * friction else ""
    open_sets = [one.effects for one in unseparated if one.reason == "these-data"]
    rivals = ", ".join(open_sets[0]) if open_sets else "several effects"
    if verdict == "no-gap":
        absorbed = f" {acting}, and the recalibrated law absorbs most of it." if causes else ""
        if weak and not causes:
            each = "each " if len(weak) > 1 else ""
            absorbed = f" {_acting(weak, unseparated)}, {each}by less than that."
        return (
            f"Once recalibrated, the simulation is systematically off by less than {share:.1%} of "
            f"friction (probability {stated(chance)}); the median is {size}.{absorbed}"
        )
    if verdict == "undecided" and not causes and gap.systematic.q05 >= share * friction:
        there = f"A gap of {size} is there (probability {stated(chance)})"
        if not weak:
            return f"{there}; what causes it stays open.{place}"
        each, else_ = ("each ", "") if len(weak) > 1 else ("", "; what else causes it stays open")
        return f"{there}; {_acting(weak, unseparated)}, {each}less than {share:.1%}{else_}.{place}"
    if verdict == "undecided":
        left = (
            f"{acting}; whether more than {share:.1%} of friction is left once the law is "
            "recalibrated stays open."
            if causes
            else f"{_acting(weak, unseparated)}, and whether as much as that counts is not sure."
            if weak
            else "no cause is sure."
        )
        return (
            f"These data leave a gap of up to {gap.systematic.q95 / friction:.1%} of friction "
            f"open: {left}"
        )
    if verdict == "unknown":
        matters = gap.systematic.q50 >= share * friction
        small = " " if matters else f", less than the {share:.1%} that counts, "
        return (
            f"A gap of {size}{small}is there, and none of the effects examined explains "
            f"it (probability {stated(chance)}).{place}"
        )
    if verdict == "unseparated":
        return (
            f"A gap of {size} is there, and one of {rivals} causes it; these data cannot tell "
            f"which (probability {stated(chance)}).{place}"
        )
    shrunk = beside = ""
    them = "it" if len(causes) == 1 else "them"
    if open_sets:
        beside = f" One of {rivals} acts beside {them}; these data cannot tell which."
    if gap.shrink is not None:
        shrunk = (
            f" The systematic gap is {size}; adding {them} takes {_share(gap.shrink)} of its "
            "square away."
        )
    return f"{acting} (probability {stated(chance)}).{shrunk}{place}{beside}"


def _lies_along(where: Sequence[Axis]) -> str:
    """Return along which axis the force lies, in a sentence; nothing where none leads."""
    for axis in where:
        if axis.answers and axis.share is not None:
            name = axis.axis.replace("_", " ")
            low, middle, high = axis.share.q05, axis.share.q50, axis.share.q95
            return f" It lies along {name} (share {middle:.2f} [{low:.2f}, {high:.2f}])."
    return ""


def _share(shrink: Interval) -> str:
    """Return a share with its interval, which is never printed as all of it."""
    if shrink.q05 >= ALL_BUT:
        return f"more than {ALL_BUT:.1%}"
    return f"{shrink.q50:.1%} [{shrink.q05:.1%}, {shrink.q95:.1%}]"


def _acting(causes: Sequence[Cause], unseparated: Sequence[Unseparated]) -> str:
    """Return that these causes act, with what this rig cannot tell from them."""
    names = {cause.effect for cause in causes}
    twins = {
        twin
        for one in unseparated
        if one.reason == "identical-on-this-rig"
        for twin in one.effects
        if names & set(one.effects)
    } - names
    alike = f" (on this rig the same as {', '.join(sorted(twins))})" if twins else ""
    acts = "acts" if len(causes) == 1 else "act"
    return f"{' and '.join(cause.effect for cause in causes)}{alike} {acts}"

"""The verdict in a sentence."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from bayesfric.diagnosis.held_out_sentence import removed_words
from bayesfric.diagnosis.verdict import Verdict
from bayesfric.diagnosis_rules import RULES
from bayesfric.probabilities import stated, two_digits
from bayesfric.schemas.causes import IMPLAUSIBLE, LEFT_OVER, Cause, Unseparated
from bayesfric.schemas.gap import Axis, Gap

PULLS = {
    False: (
        "other joints, which may have moved and are not in the log",
        "log them, or hold them still and state that",
    ),
    True: (
        "the other joints in the log, which no model of the machine describes",
        "give one (rig.robot), or hold them still",
    ),
}
"""Of joints that may have moved, by whether they are logged: what they are, and what helps."""


@dataclass(frozen=True)
class Statement:
    """The parts of a verdict sentence.

    Parameters
    ----------
    verdict : str
        As of :func:`~bayesfric.diagnosis.verdict.decide`.
    probability : float
        Probability of the verdict.
    gap : Gap
        The gap in the form that is stored.
    share : float
        The practical share of friction.
    causes : sequence of Cause
        Effects that cause the gap.
    where : sequence of Axis
        Axes of the gap.
    unseparated : sequence of Unseparated
        Sets of effects that cannot be distinguished.
    present : sequence of Cause
        Effects that act, but are each below that share, or cause no gap.
    considered : sequence of Cause
        Effects that were only considered, for example because held-out data contradict them.
    not_shown : str or None
        Why the data could not have shown a gap; None if they could.
    elsewhere : str or None
        State of other joints, if their forces may imitate the considered effects; else None.
    overruled_by : str or None
        The rule by which held-out data contradict the considered effects, with figures.
    unlike_scatter : str or None
        Description of a residual that scatter does not explain; None without one.
    recorded : str
        Number of windows, and what a window is.
    open_because : str or None
        Why the considered effects, or the cause of the gap, stay open; None if they do not.
    """

    verdict: Verdict
    probability: float
    gap: Gap
    share: float
    causes: Sequence[Cause] = ()
    where: Sequence[Axis] = ()
    unseparated: Sequence[Unseparated] = ()
    present: Sequence[Cause] = ()
    considered: Sequence[Cause] = ()
    not_shown: str | None = None
    elsewhere: str | None = None
    overruled_by: str | None = None
    unlike_scatter: str | None = None
    recorded: str = ""
    open_because: str | None = None

    @property
    def size(self) -> str:
        """The systematic gap in words: as a force and, with friction, as a share."""
        gap, middle = self.gap, self.gap.systematic.q50
        if gap.no_share is not None:
            return f"{two_digits(middle)} {gap.unit} rms"
        if middle < RULES.has_figure * gap.friction_rms:
            return f"less than {RULES.has_figure:.1%} of friction"
        share = two_digits(100 * middle / gap.friction_rms)
        return f"{two_digits(middle)} {gap.unit} rms ({share}% of friction)"

    @property
    def extent(self) -> str:
        """The gap in words, with what held-out data show where that is more."""
        gap = self.gap
        if gap.held_out_excess <= gap.systematic.q95:
            return self.size
        unseen = f"{two_digits(gap.held_out_excess)} {gap.unit} rms"
        return f"{self.size} in the data of the fit, and of {unseen} in data that it has not seen"

    @property
    def acting(self) -> str:
        """Words that the causes act."""
        return acting_words(self.causes, self.unseparated)

    @property
    def beside(self) -> str:
        """Words that weaker effects act."""
        return acting_words(self.present, self.unseparated)

    @property
    def rivals(self) -> str:
        """Effects of which one acts; empty if there are none."""
        open_sets = [pair.effects for pair in self.unseparated if pair.reason == "these-data"]
        return ", ".join(open_sets[0]) if open_sets else ""

    @property
    def place(self) -> str:
        """A sentence on the axis that explains most of the force; empty if none leads."""
        for axis in self.where:
            if axis.answers and axis.share is not None:
                name = axis.axis.replace("_", " ")
                return f" It varies most with {name}."
        return ""

    @property
    def chance(self) -> str:
        """The probability in brackets."""
        return f"(probability {stated(self.probability)})"


def sentence_of(statement: Statement) -> str:
    """Return the verdict sentence, with its probability."""
    words: dict[Verdict, Callable[[Statement], str]] = {
        "no-gap": _no_gap,
        "undecided": _undecided,
        "unknown": _unknown,
        "unseparated": _unseparated,
        "named": _named,
    }
    return words[statement.verdict](statement)


def acting_words(effects: Sequence[Cause], unseparated: Sequence[Unseparated]) -> str:
    """Return words that effects act, with the effects that this rig cannot distinguish."""
    names = {effect.effect for effect in effects}
    twins = {
        twin
        for alike in unseparated
        if alike.reason == "identical-on-this-rig"
        for twin in alike.effects
        if names & set(alike.effects)
    } - names
    alike_words = f" (on this rig the same as {', '.join(sorted(twins))})" if twins else ""
    acts = "acts" if len(effects) == 1 else "act"
    return f"{' and '.join(effect.effect for effect in effects)}{alike_words} {acts}"


def _no_gap(statement: Statement) -> str:
    absorbed = (
        f" Of the listed effects, {statement.acting}. The recalibrated law absorbs most of this "
        "force, so its coefficients include part of it."
        if statement.causes
        else ""
    )
    if statement.present and not statement.causes:
        absorbed = f" {statement.beside}, {_below(statement, 'with less than that', 'make')}."
    off = f"less than {statement.share:.1%} of friction {statement.chance}; "
    off += f"the median of the gap is {statement.size}."
    if statement.gap.no_share is not None:
        off = f"{statement.size} {statement.chance}; as a share of friction it is unknown, "
        off += f"since {statement.gap.no_share}."
    by = f" This rests on {statement.recorded}." if statement.recorded else ""
    return f"Once recalibrated, the simulation is systematically off by {off}{absorbed}{by}"


def _undecided(statement: Statement) -> str:
    gap, share = statement.gap, statement.share
    if statement.open_because is not None and not statement.considered:
        if gap.probability_above_practical < RULES.likely:
            chance = stated(gap.probability_above_practical)
            there = f"Whether there is a gap above {share:.1%} of friction stays open"
            return (
                f"{there} (its probability is {chance}): {statement.open_because}.{statement.place}"
            )
        there = f"There is a gap of {statement.extent} {statement.chance}"
        return f"{there}; its cause stays open: {statement.open_because}.{statement.place}"
    if statement.open_because is not None:
        names = " and ".join(effect.effect for effect in statement.considered)
        fits = "would explain the data, but stays" if len(statement.considered) == 1 else ""
        return (
            f"{names} {fits or 'would explain the data, but stay'} open: {statement.open_because}."
        )
    if statement.not_shown is not None and gap.no_share is not None:
        return f"These data could not have shown a gap: {statement.not_shown}; {gap.no_share}."
    if statement.not_shown is not None:
        reason = statement.not_shown
        return f"These data could not have shown a gap of {share:.1%} of friction: {reason}."
    if statement.unlike_scatter is not None:
        return (
            f"No effect examined makes a gap of {share:.1%} of friction, but scatter does not "
            f"explain the residuals: {statement.unlike_scatter}. Either something else acts, or "
            "the assumed scatter is wrong."
        )
    if not statement.causes and gap.systematic.q05 >= share * gap.friction_rms:
        there = f"There is a gap of {statement.extent} {statement.chance}"
        if not statement.present:
            return f"{there}; its cause stays open.{statement.place}"
        else_ = "; what else causes it stays open" if len(statement.present) == 1 else ""
        below = _below(statement, f"less than {share:.1%}", "make")
        return f"{there}; {statement.beside}, {below}{else_}.{statement.place}"
    left = "no cause is sure enough to be named"
    if statement.causes:
        left = f"{statement.acting}; whether the gap is above {share:.1%} of friction stays open"
    elif statement.present:
        left = f"{statement.beside}; whether its force is above {share:.1%} of friction stays open"
    return f"{_how_large(gap, share)}; {left}."


def _how_large(gap: Gap, share: float) -> str:
    """Return words for a gap as a force and as a share, with the share's interval."""
    low, middle, high = gap.systematic.q05, gap.systematic.q50, gap.systematic.q95
    if gap.no_share is not None:
        return f"The gap may be as large as {two_digits(high)} {gap.unit} rms ({gap.no_share})"
    shares = [end / gap.friction_rms for end in (low, middle, high)]
    # An end that is printed equal to the practical share would not show on which side it lies.
    digits = 2 if f"{share:.1%}" not in (f"{shares[0]:.1%}", f"{shares[2]:.1%}") else 3
    ends = " to ".join(f"{100 * end:.{digits}g}" for end in (shares[0], shares[2]))
    about = f"{shares[1]:.1%} of friction ({ends}%)"
    return f"The gap is {two_digits(middle)} {gap.unit} rms, {about}"


def _unknown(statement: Statement) -> str:
    matters = statement.gap.systematic.q50 >= statement.share * statement.gap.friction_rms
    there = f"There is a gap of {statement.extent}"
    limit = f"below {statement.share:.1%} of friction a gap is negligible"
    small = "" if matters else f" Its gap is small: {statement.size}; {limit}."
    if not statement.considered and not matters:
        return f"A force acts that none of the effects examined explains {statement.chance}.{small}"
    if not statement.considered:
        likely = stated(statement.probability)
        return (
            f"With probability {likely} there is a gap that none of the effects examined "
            f"explains: {statement.extent}.{statement.place}"
        )
    names = " and ".join(effect.effect for effect in statement.considered)
    fit = "explains" if len(statement.considered) == 1 else "explain"
    begun = f"{there}; {names}" if matters else names
    if statement.elsewhere is not None:
        pull, remedy = PULLS[statement.elsewhere == "logged"]
        return (
            f"{begun} {fit} the data, and so would the pull of {pull} "
            f"{statement.chance}: {remedy}.{small}{statement.place}"
        )
    why = statement.overruled_by
    if why is not None and IMPLAUSIBLE in why:
        return _implausible(statement, there if matters else "A force acts", small)
    part, too = ("only part of the ", " too") if why and LEFT_OVER in why else ("not ", "")
    but = f" but {part}held-out data{'' if why is None else f': {why}'}"
    return (
        f"{begun} {fit} the data of the fit{but}. Something else acts{too} {statement.chance}."
        f"{small}{statement.place}"
    )


def _implausible(statement: Statement, begun: str, small: str) -> str:
    """Return the sentence for effects that fit best but have implausible sizes."""
    considered = statement.considered
    names = " and ".join(effect.effect for effect in considered)
    closest = "effect examined is" if len(considered) == 1 else "effects examined are"
    sizes = " and ".join(_size_of(effect) for effect in considered if not effect.plausible)
    return (
        f"{begun} that none of the effects examined explains {statement.chance}.{small}"
        f"{statement.place} The closest {closest} {names}, but {sizes}, and a force that no "
        "effect explains is left."
    )


def _size_of(effect: Cause) -> str:
    """Return words for the size of an effect and its plausible range."""
    name, number = next(iter(effect.parameters.items()))
    low, high = effect.plausible_range
    unit = "" if number.unit == "1" else f" {number.unit}"
    return (
        f"the {name.replace('_', ' ')} of {effect.effect} is {number.q50:.3g}{unit}, outside of "
        f"the plausible {low:.3g} to {high:.3g}"
    )


def _unseparated(statement: Statement) -> str:
    rivals = statement.rivals or "several effects"
    return (
        f"There is a gap of {statement.extent}, and one of {rivals} causes it; these data cannot "
        f"tell which {statement.chance}.{statement.place}"
    )


def _named(statement: Statement) -> str:
    shrunk = beside = ""
    them = "it" if len(statement.causes) == 1 else "them"
    if statement.rivals:
        beside = f" One of {statement.rivals} acts beside {them}; these data cannot tell which."
    if statement.gap.shrink_of_model is not None:
        removed = removed_words(statement.gap.shrink_of_model)
        gone = f"adding {them} removes {removed} of this systematic gap (mean square)"
        without = f" Without {them} the simulation is systematically off by {statement.size}"
        shrunk = f"{without}; {gone}."
    return f"{statement.acting} {statement.chance}.{shrunk}{statement.place}{beside}"


def _below(statement: Statement, less: str, make: str) -> str:
    """Return words that weaker effects are each below a share, or that they cause no gap."""
    if all(not effect.makes_a_gap for effect in statement.present) and any(
        effect.strength >= statement.share for effect in statement.present
    ):
        return "which makes no gap" if len(statement.present) == 1 else f"which {make} no gap"
    return f"{'each ' if len(statement.present) > 1 else ''}{less}"

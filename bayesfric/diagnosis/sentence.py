"""The verdict in a sentence, and what held-out data say of it in another."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from bayesfric.diagnosis.verdict import Verdict
from bayesfric.probabilities import stated
from bayesfric.schemas import Axis, Cause, Gap, HeldOutDensity, Interval, Unseparated

ALL_BUT = 0.999
LEAST = 0.001  # of friction, below which a gap has no figure
RARELY = 0.05  # probability that the gap is not above the floor, up to which data can tell


PULLS = {
    False: (
        "other joints, which may have moved and are not in the log",
        "log them, or hold them still and say so",
    ),
    True: (
        "the other joints in the log, which no model of the machine tells",
        "give one (rig.robot), or hold them still",
    ),
}
"""Of joints that may have moved, by whether they are logged: what they are, and what helps."""


@dataclass(frozen=True)
class Statement:
    """What a sentence is made of.

    Parameters
    ----------
    verdict : str
        As of :func:`~bayesfric.diagnosis.verdict.decide`.
    probability : float
        Of what it says.
    gap : Gap
        As it is stored.
    share : float
        The practical share of friction.
    causes : sequence of Cause
        Effects that make the gap.
    where : sequence of Axis
        Axes of the gap.
    unseparated : sequence of Unseparated
        What cannot be told apart.
    present : sequence of Cause
        Effects that act and are each less than that share, or make no gap.
    considered : sequence of Cause
        Effects that held-out data contradict.
    not_shown : str or None
        Why the data could not have shown a gap; None where they could.
    elsewhere : str or None
        What other joints did, whose pull what was considered may be; None where it is not.
    overruled_by : str or None
        By which rule held-out data contradict what was considered, with its figures.
    unlike_scatter : str or None
        What is left that scatter does not explain; None where it explains all.
    recorded : str
        How many windows of how many trials say so.
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

    @property
    def size(self) -> str:
        """The systematic gap in words: as a force, and as a share where friction is there."""
        gap, middle = self.gap, self.gap.systematic.q50
        if gap.no_share is not None:
            return f"{middle:.3g} {gap.unit} rms"
        if middle < LEAST * gap.friction_rms:
            return f"less than {LEAST:.1%} of friction"
        return f"{middle:.3g} {gap.unit} rms, {middle / gap.friction_rms:.1%} of friction"

    @property
    def acting(self) -> str:
        """That the causes act."""
        return acting_words(self.causes, self.unseparated)

    @property
    def beside(self) -> str:
        """That weaker effects act."""
        return acting_words(self.present, self.unseparated)

    @property
    def rivals(self) -> str:
        """Effects of which one acts; empty where there are none."""
        open_sets = [pair.effects for pair in self.unseparated if pair.reason == "these-data"]
        return ", ".join(open_sets[0]) if open_sets else ""

    @property
    def place(self) -> str:
        """Along which axis the force lies, a sentence; empty where none leads."""
        for axis in self.where:
            if axis.answers and axis.share is not None:
                low, middle, high = axis.share.q05, axis.share.q50, axis.share.q95
                name = axis.axis.replace("_", " ")
                return f" It lies along {name} (share {middle:.2f} [{low:.2f}, {high:.2f}])."
        return ""

    @property
    def chance(self) -> str:
        """The probability in brackets."""
        return f"(probability {stated(self.probability)})"


def sentence_of(told: Statement) -> str:
    """Return the verdict in words: one thing, and the probability of that."""
    words: dict[Verdict, Callable[[Statement], str]] = {
        "no-gap": _no_gap,
        "undecided": _undecided,
        "unknown": _unknown,
        "unseparated": _unseparated,
        "named": _named,
    }
    return words[told.verdict](told)


def held_out_words(gap: Gap, causes: Sequence[Cause]) -> str:
    """Return what held-out data say, a sentence; that they cannot tell is one too."""
    row = gap.held_out[0]
    it, them = ("it", "it") if len(causes) == 1 else ("they", "them")
    raises, density = "raises" if it == "it" else "raise", gap.held_out_log_density
    better = ""
    if density is not None:
        better = f"{it} {raises} the log density of these data by {_nat(density)}"
    if causes and gap.shrink is not None:
        removed = (
            f"Of data held out, adding {them} removes {_share(gap.shrink)} of the gap (mean square)"
        )
        return f"{removed}; {better}." if better else f"{removed}."
    if causes:
        open_still = f"Data held out cannot tell what adding {them} takes: {gap.shrink_why}"
        return f"{open_still}; {better}." if better else f"{open_still}."
    sizes = f"({row.before.q50:.3g} {gap.unit} rms beside {row.floor.q50:.3g} {gap.unit})"
    if row.below_floor <= RARELY:
        return f"The law misses data held out by more than scatter explains {sizes}."
    return f"The law misses data held out by no more than scatter explains {sizes}."


def acting_words(effects: Sequence[Cause], unseparated: Sequence[Unseparated]) -> str:
    """Return that effects act, with what this rig cannot tell from them."""
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


def _no_gap(told: Statement) -> str:
    absorbed = (
        f" {told.acting}, and the recalibrated law absorbs most of it." if told.causes else ""
    )
    if told.present and not told.causes:
        absorbed = f" {told.beside}, {_below(told, 'by less than that', 'make')}."
    off = f"less than {told.share:.1%} of friction {told.chance}; the median is {told.size}"
    if told.gap.no_share is not None:
        off = f"{told.size} {told.chance}; as a share of friction it cannot be told, "
        off += f"since {told.gap.no_share}"
    by = f", by {told.recorded}" if told.recorded else ""
    return f"Once recalibrated, the simulation is systematically off by {off}{by}.{absorbed}"


def _undecided(told: Statement) -> str:
    gap, share = told.gap, told.share
    if told.not_shown is not None and gap.no_share is not None:
        return f"These data could not have shown a gap: {told.not_shown}; {gap.no_share}."
    if told.not_shown is not None:
        return (
            f"These data could not have shown a gap of {share:.1%} of friction: {told.not_shown}."
        )
    if told.unlike_scatter is not None:
        return (
            "No effect examined makes a gap that counts, and scatter does not explain all that is "
            f"left: {told.unlike_scatter}. Something else acts, or scatter is not what it is "
            "taken for."
        )
    if not told.causes and gap.systematic.q05 >= share * gap.friction_rms:
        there = f"A gap of {told.size} is there {told.chance}"
        if not told.present:
            return f"{there}; what causes it stays open.{told.place}"
        else_ = "; what else causes it stays open" if len(told.present) == 1 else ""
        below = _below(told, f"less than {share:.1%}", "make")
        return f"{there}; {told.beside}, {below}{else_}.{told.place}"
    left = "no cause is sure."
    if told.causes:
        left = (
            f"{told.acting}; whether more than {share:.1%} of friction is left once the law is "
            "recalibrated stays open."
        )
    elif told.present:
        left = f"{told.beside}, and whether as much as that counts is not sure."
    up_to = f"{gap.systematic.q95 / gap.friction_rms:.1%} of friction" if gap.friction_rms else ""
    if gap.no_share is not None:
        up_to = f"{gap.systematic.q95:.3g} {gap.unit} rms ({gap.no_share})"
    return f"These data leave a gap of up to {up_to} open: {left}"


def _unknown(told: Statement) -> str:
    matters = told.gap.systematic.q50 >= told.share * told.gap.friction_rms
    small = " " if matters else f", less than the {told.share:.1%} that counts, "
    if told.considered:
        names = " and ".join(effect.effect for effect in told.considered)
        fit = "fits" if len(told.considered) == 1 else "fit"
        if told.elsewhere is not None:
            pull, remedy = PULLS[told.elsewhere == "logged"]
            return (
                f"A gap of {told.size}{small}is there; {names} {fit} what was recorded, and so "
                f"would the pull of {pull} {told.chance}: {remedy}.{told.place}"
            )
        miss = "misses" if len(told.considered) == 1 else "miss"
        beside = "" if told.overruled_by is None else f": {told.overruled_by}"
        return (
            f"A gap of {told.size}{small}is there; {names} {fit} what was recorded and "
            f"{miss} what was held out{beside}. Something else acts {told.chance}.{told.place}"
        )
    return (
        f"A gap of {told.size}{small}is there, and none of the effects examined explains "
        f"it {told.chance}.{told.place}"
    )


def _unseparated(told: Statement) -> str:
    rivals = told.rivals or "several effects"
    return (
        f"A gap of {told.size} is there, and one of {rivals} causes it; these data cannot tell "
        f"which {told.chance}.{told.place}"
    )


def _named(told: Statement) -> str:
    shrunk = beside = ""
    them = "it" if len(told.causes) == 1 else "them"
    if told.rivals:
        beside = f" One of {told.rivals} acts beside {them}; these data cannot tell which."
    if told.gap.shrink_of_model is not None:
        removed = _share(told.gap.shrink_of_model)
        gone = f"adding {them} removes {removed} of it (mean square)"
        shrunk = f" The systematic gap is {told.size}; {gone}."
    return f"{told.acting} {told.chance}.{shrunk}{told.place}{beside}"


def _below(told: Statement, less: str, make: str) -> str:
    """Return that weaker effects are each below a share, or that they make no gap."""
    if all(not effect.makes_a_gap for effect in told.present) and any(
        effect.strength >= told.share for effect in told.present
    ):
        return "which makes no gap" if len(told.present) == 1 else f"which {make} no gap"
    return f"{'each ' if len(told.present) > 1 else ''}{less}"


def _nat(density: HeldOutDensity) -> str:
    return f"{density.difference:.3g} ± {density.error:.2g} nat"


def _share(shrink: Interval) -> str:
    """Return a share with its interval, which is never printed as all of it."""
    if shrink.q05 >= ALL_BUT:
        return f"more than {ALL_BUT:.1%}"
    return f"{shrink.q50:.1%} [{shrink.q05:.1%}, {shrink.q95:.1%}]"

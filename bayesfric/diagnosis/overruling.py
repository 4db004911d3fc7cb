"""What held-out data say against causes: by which rule and with which figures they overrule."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bayesfric.diagnosis.held_out_density import BlockDensities
from bayesfric.diagnosis.hypotheses import Search
from bayesfric.diagnosis.systematic import inclusion
from bayesfric.diagnosis.verdict import KnownEffect, sort_effects
from bayesfric.diagnosis_rules import RULES
from bayesfric.hypothesis import Hypothesis
from bayesfric.probabilities import two_digits
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import IMPLAUSIBLE, LEFT_OVER, Remainder
from bayesfric.schemas.gap import Gap, HeldOutDensity

NO_CAUSE = "no cause is named, so nothing is compared"
LIKE_CLOCKS = "clocks that differ do what the causes do, whatever is held out"
FEW_BLOCKS = (
    f"there are fewer than {RULES.least_blocks} assemblies, or runs, to hold out one after another"
)


@dataclass(frozen=True)
class Overruled:
    """What is known of effects once causes are overruled.

    Parameters
    ----------
    search : Search
        Hypotheses; those with the causes count as an unknown force for the most part.
    effects_known : list of KnownEffect
        What is known of each effect.
    present, possible : list of str
        Of the effects that were not overruled.
    """

    search: Search
    effects_known: list[KnownEffect]
    present: list[str]
    possible: list[str]


def overruled(
    search: Search,
    effects_known: Sequence[KnownEffect],
    together: Sequence[Collection[str]],
    above: float,
) -> Overruled:
    """Return what is known once hypotheses with some effects count as an unknown force.

    Parameters
    ----------
    search : Search
        The hypotheses.
    effects_known : sequence of KnownEffect
        What was known of each effect.
    together : sequence of collection of str
        Effects that act together, of each hypothesis that is overruled.
    above : float
        Probability that the gap is practical or more.
    """
    for effects in together:
        search = search.overruled(Hypothesis(effects))
    acting = inclusion(search)
    effects_known = [
        replace(effect, probability=acting.get(effect.effect, 0.0)) for effect in effects_known
    ]
    gone = {name for effects in together for name in effects}
    _, present, possible = sort_effects(
        [effect for effect in effects_known if effect.effect not in gone], above
    )
    return Overruled(search, list(effects_known), present, possible)


def density_of(
    densities: BlockDensities | None, named: Collection[str], *, like_clocks: bool = False
) -> dict[str, HeldOutDensity | str | None]:
    """Return how much better the causes predict, as a part of the gap, or why nobody knows.

    Parameters
    ----------
    densities : BlockDensities or None
        Of blocks held out.
    named : collection of str
        The causes.
    like_clocks : bool
        Whether clocks that differ do all that the causes do: the law alone then predicts as well,
        with clocks that nobody would have.
    """
    if like_clocks:
        return {"held_out_log_density": None, "held_out_log_density_why": LIKE_CLOCKS}
    if densities is None:
        return {
            "held_out_log_density": None,
            "held_out_log_density_why": FEW_BLOCKS if named else NO_CAUSE,
        }
    density = HeldOutDensity(
        difference=densities.difference, error=densities.error, blocks=densities.without.size
    )
    return {"held_out_log_density": density, "held_out_log_density_why": None}


def contradicts(gap: Gap) -> bool:
    """Return whether held-out data contradict what the model says that causes take away.

    They do where the held-out shrink is known, and its 90 % interval lies more than a tenth
    below the model's.
    """
    if gap.shrink is None or gap.shrink_of_model is None:
        return False
    return gap.shrink.q95 + RULES.shrink_missed < gap.shrink_of_model.q05


def why_overruled(
    gap: Gap,
    practical: float,
    *,
    told_as_remainder: bool,
    force_left: bool = False,
    implausible: Collection[str] = (),
) -> str | None:
    """Return by which rule held-out data contradict causes, with its figures; None if by none.

    Parameters
    ----------
    gap : Gap
        Of data held out.
    practical : float
        Practical share of friction.
    told_as_remainder : bool
        Whether a remainder tells what the causes leave.
    force_left : bool
        Whether a force that no effect explains is left, as much or little as it is.
    implausible : collection of str
        Causes that are larger or smaller than in any machine.
    """
    if contradicts(gap):
        assert gap.shrink is not None
        assert gap.shrink_of_model is not None
        return (
            f"{_share(gap.shrink)} of the squared gap is removed there, against "
            f"{_share(gap.shrink_of_model)} by the model's own estimate"
        )
    density, errors = gap.held_out_log_density, _errors_needed(gap)
    if density is not None and density.difference < errors * density.error:
        return (
            "they are predicted no better than by the law alone (log density "
            f"{density.difference:+.2g} ± {density.error:.2g} nat; "
            f"{errors:.0f} standard error{'s are' if errors > 1 else ' is'} needed)"
        )
    if leaves_too_much(gap, practical) and not told_as_remainder:
        return (
            f"after scatter is subtracted, an error of {two_digits(gap.held_out_excess)} "
            f"{gap.unit} rms is left there, and {LEFT_OVER}"
        )
    if implausible and (force_left or told_as_remainder):
        return (
            f"{' and '.join(implausible)} would be {IMPLAUSIBLE}, and a force "
            "that no effect explains is left"
        )
    return None


def _errors_needed(gap: Gap) -> float:
    """Return by how many errors causes have to predict better than the law alone.

    Of few blocks, one that tells much makes the sum and its error alike. There half of that is
    enough beside a shrink of held-out data that is surely large.
    """
    density, shrink = gap.held_out_log_density, gap.shrink
    few = density is not None and density.blocks < RULES.few_blocks
    sure = shrink is not None and shrink.q05 >= RULES.shrink_sure
    return 0.5 * RULES.predicts_better if few and sure else RULES.predicts_better


def leaves_too_much(gap: Gap, practical: float) -> bool:
    """Return whether more is left on held-out data than scatter explains, and that matters."""
    excess = gap.held_out_excess
    return excess > 0 and excess >= practical * gap.friction_rms


def why_beyond_rivals(gap: Gap) -> str | None:
    """Return why none of some rivals may make a gap; None where one of them may.

    Data held out are then missed by more than all that any of them would explain, by more than
    causes that are named may miss them by.
    """
    explained = float(np.hypot(gap.systematic.q95, gap.floor.q95))
    if explained**2 >= (1 - RULES.shrink_missed) * gap.before.q05**2:
        return None
    return (
        f"data held out are missed by {gap.before.q05:.3g} {gap.unit} rms or more, and effects "
        f"with scatter explain {explained:.3g} {gap.unit} at most"
    )


def tells_what_is_left(remainder: Remainder, gap: Gap) -> bool:
    """Return whether a remainder tells what the causes leave of held-out data.

    One that is a small part of what they leave does not: the rest is a force of another kind, or
    numbers that hold for these data alone.

    Parameters
    ----------
    remainder : Remainder
        Beside the causes.
    gap : Gap
        Of data held out.
    """
    if not remainder.significant or remainder.share_of_gap is None:
        return remainder.significant
    explained = float(np.sqrt(remainder.share_of_gap.q95)) * gap.systematic.q95
    return gap.held_out_excess <= RULES.remainder_tells * explained


def _share(shrink: Interval) -> str:
    return f"{min(shrink.q50, 1.0):.0%}"

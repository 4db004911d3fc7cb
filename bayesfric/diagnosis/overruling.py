"""The rules by which held-out data contradict causes, with the figures behind them."""

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
    """Hypotheses and effects after causes were overruled.

    Parameters
    ----------
    search : Search
        Hypotheses; most probability of those with the causes belongs to an unknown force.
    effects_known : list of KnownEffect
        Probability and strength of each effect.
    present, possible : list of str
        Effects that were not overruled.
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
    """Return hypotheses and effects after some effects count as an unknown force.

    Parameters
    ----------
    search : Search
        The hypotheses.
    effects_known : sequence of KnownEffect
        Probability and strength of each effect before.
    together : sequence of collection of str
        Sets of effects that are overruled.
    above : float
        Probability that the gap is at least of practical size.
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
    """Return the gain in held-out log density by the causes, or why there is none, as gap fields.

    Parameters
    ----------
    densities : BlockDensities or None
        Log densities of held-out blocks.
    named : collection of str
        The causes.
    like_clocks : bool
        Whether clock errors can make the whole force of the causes: the law alone then predicts
        as well, with unrealistic clock errors.
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
    """Return whether held-out data contradict the model's shrink of the gap by the causes.

    They do if the 90 % interval of the held-out shrink lies more than a tenth below that of
    the model.
    """
    if gap.shrink is None or gap.shrink_of_model is None:
        return False
    return gap.shrink.q95 + RULES.shrink_missed < gap.shrink_of_model.q05


def why_overruled(
    gap: Gap,
    practical: float,
    *,
    in_remainder: bool,
    force_left: bool = False,
    implausible: Collection[str] = (),
) -> str | None:
    """Return the rule by which held-out data contradict causes, with figures; None without one.

    Parameters
    ----------
    gap : Gap
        The gap on held-out data.
    practical : float
        Practical share of friction.
    in_remainder : bool
        Whether the remainder accounts for the residual of the causes.
    force_left : bool
        Whether an unexplained force of any size is left.
    implausible : collection of str
        Causes with implausible sizes.
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
    if leaves_too_much(gap, practical) and not in_remainder:
        return (
            f"after scatter is subtracted, an error of {two_digits(gap.held_out_excess)} "
            f"{gap.unit} rms is left there, and {LEFT_OVER}"
        )
    if implausible and (force_left or in_remainder):
        return (
            f"{' and '.join(implausible)} would be {IMPLAUSIBLE}, and a force "
            "that no effect explains is left"
        )
    return None


def _errors_needed(gap: Gap) -> float:
    """Return how many standard errors the density gain of causes must exceed.

    With few blocks, one informative block dominates both the sum and its error. Half the number
    is then enough, if the held-out shrink is certainly large.
    """
    density, shrink = gap.held_out_log_density, gap.shrink
    few = density is not None and density.blocks < RULES.few_blocks
    sure = shrink is not None and shrink.q05 >= RULES.shrink_sure
    return 0.5 * RULES.predicts_better if few and sure else RULES.predicts_better


def leaves_too_much(gap: Gap, practical: float) -> bool:
    """Return whether the held-out residual beyond scatter is of practical size."""
    excess = gap.held_out_excess
    return excess > 0 and excess >= practical * gap.friction_rms


def why_beyond_rivals(gap: Gap) -> str | None:
    """Return why no rival can be the cause of the gap; None if one can.

    The reason is that the held-out residual exceeds what any of them explains by more than is
    allowed for named causes.
    """
    explained = float(np.hypot(gap.systematic.q95, gap.floor.q95))
    if explained**2 >= (1 - RULES.shrink_missed) * gap.before.q05**2:
        return None
    return (
        f"data held out are missed by {gap.before.q05:.3g} {gap.unit} rms or more, and effects "
        f"with scatter explain {explained:.3g} {gap.unit} at most"
    )


def accounts_for_residual(remainder: Remainder, gap: Gap) -> bool:
    """Return whether a remainder accounts for the held-out residual of the causes.

    A remainder that is a small part of this residual does not: the rest is another kind of force,
    or a fit that does not generalise.

    Parameters
    ----------
    remainder : Remainder
        The remainder after the causes.
    gap : Gap
        The gap on held-out data.
    """
    if not remainder.significant or remainder.share_of_gap is None:
        return remainder.significant
    explained = float(np.sqrt(remainder.share_of_gap.q95)) * gap.systematic.q95
    return gap.held_out_excess <= RULES.remainder_tells * explained


def _share(shrink: Interval) -> str:
    return f"{min(shrink.q50, 1.0):.0%}"

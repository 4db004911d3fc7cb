"""The verdict, by the rules of the contract, and in a sentence."""

from collections.abc import Mapping
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from bayesfric.diagnosis.which import NONE, UNKNOWN, Which
from bayesfric.schemas import Axis, Cause, Gap, Unseparated

__all__ = ["decide", "sentence_of", "unseparated_of"]

Array = NDArray[np.float64]
Verdict = Literal["no-gap", "named", "unseparated", "unknown"]
HALF, NAMED = 0.5, 0.9
UPPER = 0.95
RIVAL = 0.05  # probability from which on a hypothesis counts among those not told apart


def decide(
    chances: Mapping[str, float], systematic: Array, practical: float
) -> tuple[Verdict, float]:
    """Return the verdict and its probability.

    Parameters
    ----------
    chances : mapping of str to float
        Posterior probabilities of hypotheses.
    systematic : ndarray
        Draws of the systematic gap [N].
    practical : float
        A gap below it is none [N].
    """
    none, unknown = chances.get(NONE, 0.0), chances.get(UNKNOWN, 0.0)
    if none >= HALF:
        return "no-gap", none
    # The floor is known from scatter around a law; where only an unknown force explains the
    # data there is none to take the gap's distance from.
    if unknown < HALF and np.quantile(systematic, UPPER) < practical:
        return "no-gap", float(np.mean(systematic < practical))
    if unknown >= HALF:
        return "unknown", unknown
    best = max((p for name, p in chances.items() if name not in (NONE, UNKNOWN)), default=0.0)
    if best >= NAMED:
        return "named", best
    return "unseparated", 1 - none - unknown


def unseparated_of(
    which: Which, chances: Mapping[str, float], verdict: Verdict
) -> tuple[Unseparated, ...]:
    """Return what is identical on this rig, and what these data leave open."""
    found = [
        Unseparated(effects=members, reason="identical-on-this-rig")
        for members in which.classes.members
        if len(members) > 1
    ]
    open_ = tuple(name for name, chance in chances.items() if chance >= RIVAL)
    if verdict == "unseparated" and len(open_) > 1:
        found.append(Unseparated(effects=open_, reason="these-data"))
    return tuple(found)


def sentence_of(
    verdict: Verdict,
    chance: float,
    causes: tuple[Cause, ...],
    gap: Gap,
    where: tuple[Axis, ...],
    unseparated: tuple[Unseparated, ...],
) -> str:
    """Return the verdict in words."""
    before, floor = f"{gap.before.q50:.3g} N", f"{gap.floor.q50:.3g} N"
    if verdict == "no-gap":
        return (
            f"Once recalibrated, the simulation misses held-out friction by {before} rms, and "
            f"friction's own scatter is {floor} (probability {chance:.2f})."
        )
    if verdict == "unknown":
        axis = next((one.axis for one in where if not one.blind), None)
        place = f", most of all along {axis.replace('_', ' ')}" if axis else ""
        return (
            f"There is a gap of {gap.systematic.q50:.3g} N rms{place}, and none of the effects "
            f"examined explains it (probability {chance:.2f})."
        )
    names = " and ".join(cause.effect for cause in causes)
    twins = {
        twin
        for one in unseparated
        if one.reason == "identical-on-this-rig"
        for twin in one.effects
        if {cause.effect for cause in causes} & set(one.effects)
    } - {cause.effect for cause in causes}
    alike = f" (on this rig the same as {', '.join(sorted(twins))})" if twins else ""
    if verdict == "named":
        shrunk = "" if gap.shrink is None else f", which takes {gap.shrink.q50:.0%} of it away"
        return (
            f"The gap of {gap.systematic.q50:.3g} N rms comes from {names}{alike}{shrunk} "
            f"(probability {chance:.2f})."
        )
    rivals = next((one.effects for one in unseparated if one.reason == "these-data"), ())
    return (
        f"There is a gap of {gap.systematic.q50:.3g} N rms, and these data cannot tell apart "
        f"{', '.join(rivals) or names}."
    )

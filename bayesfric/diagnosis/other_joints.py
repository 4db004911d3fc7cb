"""What a joint's neighbours may have done to it: effects that they look like, and their pull."""

from collections.abc import Collection, Mapping

import numpy as np

from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.weighing import Weighed
from bayesfric.diagnosis_rules import RULES
from bayesfric.effects import Effect
from bayesfric.rigs.model_amounts import ModelAmounts
from bayesfric.schemas.causes import ModelError
from bayesfric.schemas.gap import Gap

PLACED = frozenset({"angle", "load-both-ways", "period", "play", "position", "spring"})
"""Needs of effects of a position, of reversals behind a play or a spring, and of a gear's load."""
LISTED = 3  # numbers of a model that a sentence has


def looks_like_others(
    named: Collection[str],
    rivals: Collection[str],
    examined: Mapping[str, Effect],
    others: str | None,
    gap: Gap,
    amounts: ModelAmounts | None,
) -> bool:
    """Return whether causes are of a kind that the pull of a joint looks like that is not logged.

    Where nobody says what other joints did, they are taken to have moved if more is left of the
    force than a machine's own friction scatters; where they are logged and there is no model,
    that much says that what they do is not told by the form that it was given.

    Parameters
    ----------
    named : collection of str
        Causes.
    rivals : collection of str
        Effects of which one acts, and these data do not tell which.
    examined : mapping of str to Effect
        All effects that were examined.
    others : str or None
        What other joints did: ``still``, ``logged``, ``moving`` or ``unknown``.
    gap : Gap
        With what causes leave of data held out, and what a perfect law would leave.
    amounts : ModelAmounts or None
        Of the errors of the machine's model; None without one.
    """
    # Where no cause is named nothing was added whose rest could be seen.
    rest = max(gap.floor.q50, gap.after.q50) if named else gap.floor.q50
    left = rest >= max(
        RULES.other_joints_left * gap.friction_rms, RULES.other_joints_of_gap * gap.before.q50
    )
    open_still = others in ("unknown", "logged") and amounts is None
    moved = others == "moving" or (open_still and left)
    acting = [examined[name] for name in (*named, *rivals) if name in examined]
    return moved and any(_is_placed(effect) for effect in acting)


def _is_placed(effect: Effect) -> bool:
    return bool(effect.needs & PLACED) or "travel_m" in effect.edge


def amounts_of(model: LinearModel, best: Weighed) -> ModelAmounts | None:
    """Return how wrong the machine's model is by the likeliest hypothesis; None without one."""
    count = model.layout.nuisances[0]
    mean, covariance = best.at.mean[-count:], best.at.covariance[-count:, -count:]
    return model.data.rigs[0].model_amounts(np.asarray(mean), np.asarray(covariance))


def model_error_words(errors: Collection[ModelError]) -> str:
    """Return that a model is off, a sentence with a blank before it; empty where it is not."""
    off = [error for error in errors if error.significant]
    if not off:
        return ""
    parts = [
        f"{error.number} of {error.link} by {error.error.mean:+.3g} ± {error.error.sd:.2g} "
        f"{error.unit} (your model has {error.in_your_model:.3g})"
        for error in off[:LISTED]
    ]
    more = f", and {len(off) - LISTED} more" if len(off) > LISTED else ""
    return f" Your model of the machine is off: {'; '.join(parts)}{more}."

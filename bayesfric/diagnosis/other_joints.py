"""Forces that other joints exert on a joint, and the effects that they imitate."""

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
LISTED = 3  # most numbers of a model that a sentence lists


def looks_like_others(
    named: Collection[str],
    rivals: Collection[str],
    examined: Mapping[str, Effect],
    others: str | None,
    gap: Gap,
    amounts: ModelAmounts | None,
) -> bool:
    """Return whether causes may be imitated by forces of other, unlogged joints.

    If nothing is known of other joints, they count as moved if the residual exceeds the usual
    scatter of a machine's friction. If they are logged without a model, such a residual shows that
    the assumed form of their forces does not hold.

    Parameters
    ----------
    named : collection of str
        Causes.
    rivals : collection of str
        Effects of which one acts; these data do not determine which.
    examined : mapping of str to Effect
        All examined effects.
    others : str or None
        State of other joints: ``still``, ``logged``, ``moving`` or ``unknown``.
    gap : Gap
        Contains the held-out residual of the causes, and that of a perfect law.
    amounts : ModelAmounts or None
        Estimated errors of the machine's model; None without a model.
    """
    # Without a named cause, the residual after causes is not defined.
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
    """Return the errors of the machine's model under a hypothesis; None without a model."""
    count = model.layout.nuisances[0]
    mean, covariance = best.at.mean[-count:], best.at.covariance[-count:, -count:]
    return model.data.rigs[0].model_amounts(np.asarray(mean), np.asarray(covariance))


def model_error_words(errors: Collection[ModelError]) -> str:
    """Return a sentence about errors of a model, with a leading blank; empty without errors."""
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

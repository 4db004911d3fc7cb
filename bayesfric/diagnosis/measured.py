"""The gap on held-out data, and the prediction by which a verdict on causes is judged.

The stored figures compare the law with the causes alone. If one of several effects acts beside the
causes and the data cannot tell which, the causes alone must fail on held-out data. A second
prediction then contains the most probable of these effects too.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import chain
from typing import NamedTuple

import numpy as np

from bayesfric.arrays import Array
from bayesfric.checkpoint import Checkpoint
from bayesfric.diagnosis.arms import Arms
from bayesfric.diagnosis.compared import Compared
from bayesfric.diagnosis.held_out import HeldOut, measure_gap
from bayesfric.diagnosis.held_out_density import BlockDensities, block_densities
from bayesfric.diagnosis.judging import Judged, arms_with
from bayesfric.diagnosis.overruling import density_of
from bayesfric.diagnosis.question import Question
from bayesfric.diagnosis.residuals import Residuals, residuals_of
from bayesfric.diagnosis.showing import share_of_friction
from bayesfric.diagnosis.stored import gap_of
from bayesfric.diagnosis.verdict import sets_of_one
from bayesfric.diagnosis.weighing import Weighed
from bayesfric.hypothesis import NONE, Hypothesis
from bayesfric.schemas.gap import Gap, HeldOutDensity

EXPLAINED = (
    "floor_agrees",
    "floor_disagreement",
    "floor_disagreement_why",
    "held_out_excess",
)
"""Fields of the gap that state whether the model explains the held-out data."""


@dataclass(frozen=True)
class Measured:
    """The gap on held-out data.

    Parameters
    ----------
    held_out : HeldOut
        Residuals without and with the causes, fold by fold.
    gap : Gap
        The gap in the form that is stored.
    left : ndarray or None
        Draws of the part of the squared gap that the causes leave, if it is of practical size.
    judging : Gap
        The gap by which the causes are judged. It is `gap`, unless an effect acts beside the
        causes that the data cannot tell from others: then the causes predict together with it.
    beside : frozenset of str
        The effects that predict together with the causes in `judging`.
    """

    held_out: HeldOut
    gap: Gap
    left: Array | None
    judging: Gap
    beside: Hypothesis = NONE


def measure(
    question: Question,
    compared: Compared,
    judged: Judged,
    keeping: Checkpoint,
    folds: np.random.Generator,
    bootstrap: np.random.Generator,
    blocks: np.random.Generator,
) -> Measured:
    """Return the gap on held-out data, without and with the causes.

    Parameters
    ----------
    question : Question
        The recording and what is asked of it.
    compared : Compared
        The hypotheses.
    judged : Judged
        Which effects are causes.
    keeping : Checkpoint
        Stores the slow steps.
    folds, bootstrap, blocks : Generator
        Sources of randomness for folds, for intervals, and for left-out blocks.
    """
    own = _HeldOutGap(
        question, compared, judged, keeping, _densities_of(compared, judged, keeping, blocks)
    )
    (other_folds,), (other_bootstrap,) = folds.spawn(1), bootstrap.spawn(1)
    held_out, gap, left = own.of("held-out", judged.arms, judged.plain, folds, bootstrap)
    beside = best_beside(judged)
    if beside is None:
        return Measured(held_out, gap, left, gap)
    arms = arms_with(compared.model, *beside, judged.arms)
    plain = residuals_of(arms.plain, arms.psi)
    _, judging, _ = own.of("held-out-beside", arms, plain, other_folds, other_bootstrap)
    explained = {name: getattr(judging, name) for name in EXPLAINED}
    added = Hypothesis(beside[1] - set(judged.named))
    return Measured(held_out, gap.model_copy(update=explained), left, judging, added)


def _densities_of(
    compared: Compared, judged: Judged, keeping: Checkpoint, blocks: np.random.Generator
) -> Mapping[str, HeldOutDensity | str | None]:
    """Return the gain in held-out log density by the causes, as fields of the gap."""
    densities = keeping.record(
        "held-out-density",
        BlockDensities | None,
        lambda: block_densities(compared.model, judged.search, judged.named, blocks),
    )
    like_clocks = judged.arms.like_clocks(judged.plain)
    return density_of(densities, judged.named, like_clocks=like_clocks)


class _HeldOutGap(NamedTuple):
    """What the gap on held-out data depends on, except for the effects that predict."""

    question: Question
    compared: Compared
    judged: Judged
    keeping: Checkpoint
    densities: Mapping[str, HeldOutDensity | str | None]

    def of(
        self,
        name: str,
        arms: Arms,
        plain: Residuals,
        folds: np.random.Generator,
        bootstrap: np.random.Generator,
    ) -> tuple[HeldOut, Gap, Array | None]:
        """Return residuals, the gap, and what the effects of the arms leave of its square."""
        judged, compared = self.judged, self.compared
        held_out = self.keeping.record(name, HeldOut, lambda: measure_gap(arms, plain, folds))
        gap, left = gap_of(
            held_out,
            judged.posterior,
            judged.residuals,
            arms,
            self.question.practical,
            bootstrap,
            compared.data.unit,
        )
        shares = share_of_friction(compared.model, judged.residuals, judged.posterior)
        return held_out, gap.model_copy(update={**shares, **self.densities}), left


def best_beside(judged: Judged) -> tuple[Weighed, Hypothesis] | None:
    """Return the causes with the most probable of the effects of which one acts beside them.

    Parameters
    ----------
    judged : Judged
        Which effects are causes.

    Returns
    -------
    tuple of (Weighed, Hypothesis), or None
        The most probable hypothesis with the causes and such an effect, and these effects of it;
        None without causes, or without such effects.
    """
    search, named = judged.search, Hypothesis(judged.named)
    chances = search.probabilities()
    rivals = frozenset(chain(*sets_of_one(chances, judged.effects_known, judged.named)))
    within = [
        weighed
        for weighed in search.weighed.values()
        if named <= weighed.hypothesis
        and rivals & weighed.hypothesis
        and not search.doubted & weighed.hypothesis
    ]
    if not named or not within:
        return None
    best = max(within, key=search.worth)
    return best, Hypothesis(best.hypothesis & (named | rivals))

"""The gain in held-out log predictive density by the causes.

Blocks of assemblies, or of runs and parts of runs of an axis, are left out one at a time. Given the
noise, the log density of a block given all others is a difference of two log evidences in closed
form. The law with the causes and the law without them contain the same further effects. Each has
the noise of its own mode, because the law without causes needs more scatter.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.diagnosis.acting import Acting, Law
from bayesfric.diagnosis.climbing import climb
from bayesfric.diagnosis.hypotheses import Search
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.weighing import Weighed
from bayesfric.diagnosis_rules import RULES

MOST_BLOCKS = 20
LEAST_ERROR = 1e-9  # nat


@dataclass(frozen=True)
class BlockDensities:
    """Log predictive densities of blocks, each given all others.

    Parameters
    ----------
    without, beside : ndarray, shape (B,)
        Of the law without the causes, and of the law with the causes [nat].
    """

    without: Array
    beside: Array

    @property
    def difference(self) -> float:
        """Gain in log predictive density by the causes, summed over blocks [nat]."""
        return float(np.sum(self.beside - self.without))

    @property
    def error(self) -> float:
        """Standard error of that sum, from the differences between blocks [nat]."""
        differences = self.beside - self.without
        return float(np.sqrt(differences.size) * np.std(differences, ddof=1))


def blocks_of(model: LinearModel, rng: np.random.Generator) -> list[Whole]:
    """Return the block of each trial, rig by rig.

    A block is an assembly; with more than :data:`MOST_BLOCKS` assemblies, it contains several.

    Parameters
    ----------
    model : LinearModel
        All rigs.
    rng : Generator
        Source of randomness for the grouping of assemblies.
    """
    counts = [int(rig.setup.max()) + 1 for rig in model.rigs]
    block = rng.permutation(sum(counts)) % min(MOST_BLOCKS, sum(counts))
    starts = np.cumsum([0, *counts[:-1]])
    return [
        np.asarray(block[start + rig.setup], dtype=np.intp)
        for start, rig in zip(starts, model.rigs, strict=True)
    ]


def block_densities(
    model: LinearModel, search: Search, causes: Collection[str], rng: np.random.Generator
) -> BlockDensities | None:
    """Return the log densities of held-out blocks, with and without the causes.

    Parameters
    ----------
    model : LinearModel
        The model in which the hypotheses were compared.
    search : Search
        The hypotheses.
    causes : collection of str
        Effects that are removed for the comparison.
    rng : Generator
        Source of randomness for the grouping of assemblies in blocks.

    Returns
    -------
    BlockDensities or None
        None if no hypothesis has the causes, or if there are fewer blocks than the rules
        require.
    """
    within = [
        weighed
        for weighed in search.weighed.values()
        if weighed.hypothesis.issuperset(causes) and not search.doubted & weighed.hypothesis
    ]
    if not causes or not within:
        return None
    best = max(within, key=search.worth)
    alone, beside = _one_by_one(model, best)
    without = _without(beside, causes)
    block = blocks_of(alone, rng)
    if max(int(numbers.max()) for numbers in block) + 1 < RULES.least_blocks:
        return None
    noise = best.at.psi[: len(model.noise)]
    start = np.concatenate([noise, best.at.psi[len(model.noise) :]])
    kept = [place for place, law in enumerate(beside.phases) if law.effect not in causes]
    start_without = np.concatenate([noise, best.at.psi[len(model.noise) :][kept]])
    used = _rests(alone, block)
    return BlockDensities(
        _densities(alone, without, start_without, used), _densities(alone, beside, start, used)
    )


def least_needed_cause(
    model: LinearModel, search: Search, causes: Collection[str], rng: np.random.Generator
) -> str | None:
    """Return the cause that improves held-out predictions least, if it may improve nothing.

    A pair must predict better than each effect alone: any of about twenty further effects may
    correct a slightly wrong law, and the best of them gains two standard errors by chance alone.
    A cause that improves the density of every block is never returned. None if each cause
    improves the density by enough standard errors, or if nothing can be held out.

    Parameters
    ----------
    model, search, causes, rng
        As of :func:`block_densities`.
    """
    seed = int(rng.integers(2**32))
    errors = {}
    for name in causes:
        densities = block_densities(model, search, [name], np.random.default_rng(seed))
        if densities is None:
            return None
        if np.any(densities.beside <= densities.without):
            errors[name] = densities.difference / max(densities.error, LEAST_ERROR)
    doubtful = {name: by for name, by in errors.items() if by < RULES.predicts_beside}
    return min(doubtful, key=lambda name: doubtful[name]) if doubtful else None


def _one_by_one(model: LinearModel, best: Weighed) -> tuple[LinearModel, Acting]:
    """Return a model with a hypothesis' effects alone, from which assemblies can be left out."""
    acting = best.acting
    columns = [
        model.candidate(law, shape) for law, shape in zip(acting.laws, acting.shapes, strict=True)
    ]
    phases = [model.candidate(law, 0.0) for law in acting.phases]
    setups = {rig.rows.name: rig.setup for rig in model.rigs}
    alone = model.full.around(model.laws, [*columns, *phases], together=setups)
    laws = tuple(
        Law(law.effect, law.law, (place,), (shape,), 0.0)
        for place, (law, shape) in enumerate(zip(acting.laws, acting.shapes, strict=True))
    )
    placed = tuple(
        replace(law, places=(len(columns) + place,)) for place, law in enumerate(acting.phases)
    )
    return alone, Acting(laws, acting.shapes, placed)


def _without(acting: Acting, causes: Collection[str]) -> Acting:
    """Return the effects that act, without the causes."""
    kept = [
        (law, shape)
        for law, shape in zip(acting.laws, acting.shapes, strict=True)
        if law.effect not in causes
    ]
    phases = tuple(law for law in acting.phases if law.effect not in causes)
    return Acting(tuple(law for law, _ in kept), tuple(shape for _, shape in kept), phases)


def _rests(model: LinearModel, block: Sequence[Whole]) -> list[Mapping[str, Flags]]:
    """Return for each block which trials of each rig are outside it."""
    names = [rig.rows.name for rig in model.rigs]
    last = max(int(numbers.max()) for numbers in block)
    return [
        {name: own != number for name, own in zip(names, block, strict=True)}
        for number in range(last + 1)
    ]


def _densities(
    model: LinearModel, acting: Acting, start: Array, rests: Sequence[Mapping[str, Flags]]
) -> Array:
    """Return the log density of each block given the rest, at the mode of the noise, (B,)."""
    psi = climb(model, start, acting).psi
    whole = model.evaluate(psi, acting).value
    return np.array([whole - model.evaluate(psi, acting, used=rest).value for rest in rests])

"""What is said of each effect, from hypotheses that were weighed to causes.

An effect is named by what its laws do. They may be wrong by a share of themselves, and take up a
part of a force that nobody named; what they then leave of the gap tells. Where effects that act
leave more than a part of the squared gap, at whatever amplitudes, that hypothesis is one of an
unknown force.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bayesfric.diagnosis.acting import Acting, At, Law
from bayesfric.diagnosis.arms import Arms
from bayesfric.diagnosis.causes import known_of
from bayesfric.diagnosis.hypotheses import UNKNOWN, Search
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.residuals import Residuals, residuals_of
from bayesfric.diagnosis.systematic import SMALLEST, Posterior, posterior_of, shrink_of
from bayesfric.diagnosis.verdict import HALF, Known, sort_effects
from bayesfric.diagnosis.weighing import Weighed
from bayesfric.physics.friction import Coefficients

__all__ = ["Judged", "judge"]

Array = NDArray[np.float64]
FOREIGN = 0.15  # of the squared gap, beyond which it is not made by the effects that are named
RARE = 0.003  # probability of that, below which it is left out


@dataclass(frozen=True)
class Judged:
    """Effects sorted, and what they were sorted by.

    Parameters
    ----------
    search : Search
        Hypotheses; what leaves too much counts as unknown.
    settled : At
        The most probable, at its noise.
    residuals : Residuals
        Windows at that noise.
    posterior : Posterior
        Draws.
    known : list of Known
        What is known of each effect.
    named, present, possible : list of str
        Causes, those too weak to matter, and those that are possible.
    arms : Arms
        The law without and with the causes.
    plain : Residuals
        Windows of the first of these.
    """

    search: Search
    settled: At
    residuals: Residuals
    posterior: Posterior
    known: list[Known]
    named: list[str]
    present: list[str]
    possible: list[str]
    arms: Arms
    plain: Residuals


def judge(
    model: LinearModel,
    search: Search,
    shipped: Mapping[str, Coefficients],
    practical: float,
    rng: np.random.Generator,
) -> Judged:
    """Sort effects, and count as unknown what named ones cannot have made.

    Parameters
    ----------
    model : LinearModel
        In which the hypotheses were compared.
    search : Search
        The hypotheses.
    shipped : mapping of str to Coefficients
        The law as it was shipped, by pulley size.
    practical : float
        Practical share of friction.
    rng : Generator
        Source of randomness.
    """
    judged = _judged(model, search, shipped, practical, rng)
    if not judged.named or search.unknown is None:
        return judged
    share = _leaves_too_much(judged, practical)
    if share < RARE:
        return judged
    foreign = {frozenset(judged.named): share}
    return _judged(model, replace(search, foreign=foreign), shipped, practical, rng)


def _judged(
    model: LinearModel,
    search: Search,
    shipped: Mapping[str, Coefficients],
    practical: float,
    rng: np.random.Generator,
) -> Judged:
    best, force = search.best(), search.unknown
    mostly = search.probabilities()[UNKNOWN] >= HALF
    settled = force.at if mostly and force is not None else best.at
    residuals = residuals_of(model.full, settled.psi)
    posterior = posterior_of(model, search, residuals, rng)
    known = known_of(model, search, posterior, practical)
    named, present, possible = sort_effects(known)
    arms = _arms(model, search, best, named, settled.psi, shipped)
    plain = residuals_of(arms.plain, arms.psi)
    return Judged(
        search, settled, residuals, posterior, known, named, present, possible, arms, plain
    )


def _leaves_too_much(judged: Judged, practical: float) -> float:
    """Return how probably the causes, if they act, leave too much of the gap."""
    residuals, posterior = judged.residuals, judged.posterior
    if not judged.arms.causes.laws:
        return 0.0
    own = residuals.without_law(judged.arms.of_causes(judged.plain))
    shrink = shrink_of(residuals, posterior, own)
    if shrink is None:
        return 0.0
    there = posterior.gap > SMALLEST * residuals.friction_rms
    left = np.clip(1 - shrink, 0.0, 1.0)
    felt = np.sqrt(left) * posterior.gap[there] / residuals.friction_rms
    acting = [set(judged.named) <= set(one.split("+")) for one in posterior.hypothesis[there]]
    found = ((left > FOREIGN) & (felt >= practical))[acting]
    return float(found.mean()) if found.size else 0.0


def _arms(
    model: LinearModel,
    found: Search,
    best: Weighed,
    named: Collection[str],
    psi: Array,
    shipped: Mapping[str, Coefficients],
) -> Arms:
    within = [one for one in found.weighed.values() if set(one.names) == set(named)]
    chosen = within[0] if within else best
    laws = [law for law in chosen.acting.laws if law.effect in named]
    shapes = [
        shape
        for law, shape in zip(chosen.acting.laws, chosen.acting.shapes, strict=True)
        if law.effect in named
    ]
    own = [model.candidate(law, shape) for law, shape in zip(laws, shapes, strict=True)]
    own = [replace(one, node=shape) for one, shape in zip(own, shapes, strict=True)]
    plain = model.around(model.laws, own, discrepancy=False, by_trial=False)
    known = model.around(model.laws, own, by_trial=True)
    acting = tuple(
        Law(law.effect, law.law, (place,), (shape,), 0.0)
        for place, (law, shape) in enumerate(zip(laws, shapes, strict=True))
    )
    complete = set(shipped) >= set(model.layout.sizes)
    causes = Acting(
        acting, tuple(shapes), tuple(law for law in chosen.acting.phases if law.effect in named)
    )
    shipped_here = {size: shipped[size] for size in model.layout.sizes if size in shipped}
    return Arms(plain, known, psi[: len(model.noise)], causes, shipped_here if complete else None)

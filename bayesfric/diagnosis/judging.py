"""Sorts effects into causes, present and possible ones, from hypotheses with evidences.

Each law of an effect may have a relative error, so effects may imitate an unlisted force. What they
leave of the gap without these errors shows this. If effects leave more than a given part of the
squared gap, at their best amplitudes and shapes, their hypothesis counts as an unknown force.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bayesfric.arrays import Array, Flags
from bayesfric.diagnosis.acting import Acting, At, Law
from bayesfric.diagnosis.arms import Arms
from bayesfric.diagnosis.causes import reported_effects
from bayesfric.diagnosis.hypotheses import Search
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.residuals import Residuals, residuals_of
from bayesfric.diagnosis.systematic import (
    SMALLEST,
    Posterior,
    best_of,
    left_of,
    posterior_of,
    shrink_of,
)
from bayesfric.diagnosis.unknown import Unknown
from bayesfric.diagnosis.verdict import KnownEffect, sort_effects
from bayesfric.diagnosis.weighing import Weighed
from bayesfric.diagnosis_rules import RULES
from bayesfric.effects.candidates import SHAPE_NODES
from bayesfric.hypothesis import UNKNOWN, Hypothesis
from bayesfric.observation.layout import COEFFICIENTS
from bayesfric.physics.friction import Coefficients

PASSES = 2  # over the shapes of causes, one shape at a time


@dataclass(frozen=True)
class Judged:
    """Sorted effects, and the results by which they were sorted.

    Parameters
    ----------
    search : Search
        Hypotheses; effects that leave too much of the gap count as an unknown force.
    settled : At
        The most probable hypothesis at the mode of its noise.
    residuals : Residuals
        Windows at these noise parameters.
    posterior : Posterior
        Draws over all hypotheses.
    effects_known : list of KnownEffect
        Probability and strength of each effect.
    named, present, possible : list of str
        Causes, effects too weak to matter, and possible effects.
    arms : Arms
        The law without and with the causes.
    plain : Residuals
        Windows of `arms.plain`.
    above : float
        Probability that the gap is at least of practical size.
    """

    search: Search
    settled: At
    residuals: Residuals
    posterior: Posterior
    effects_known: list[KnownEffect]
    named: list[str]
    present: list[str]
    possible: list[str]
    arms: Arms
    plain: Residuals
    above: float


def judge(
    model: LinearModel,
    search: Search,
    shipped: Mapping[str, Coefficients],
    practical: float,
    rng: np.random.Generator,
) -> Judged:
    """Sort effects; a gap that they cannot make counts as an unknown force.

    Parameters
    ----------
    model : LinearModel
        The model in which the hypotheses were compared.
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
    minor = _largest_alone(model, search, judged, practical)
    if minor is not None:
        search = replace(search, minor=minor)
        judged = _judged(model, search, shipped, practical, rng)
    if not judged.named or search.unknown is None:
        return judged

    def leaves(compared: Judged) -> float:
        return _leaves_too_much(
            compared, practical, lambda acting: _own_force(model, search, compared, acting)
        )

    share, again = leaves(judged), judged
    if share >= RULES.rare:
        # A shape that was fitted with an error of its law may be poor without this error.
        reshaped = _reshaped(model, judged)
        other = share if reshaped is None else leaves(reshaped)
        if reshaped is not None and other < share:
            share, again = other, reshaped
    if share < RULES.rare:
        return again
    foreign = {Hypothesis(judged.named): share}
    moved = replace(
        search, foreign=foreign, unknown=_with_causes(model, search.unknown, search.best())
    )
    outcome = _judged(model, moved, shipped, practical, rng)
    if outcome.named != judged.named:
        return outcome
    return replace(outcome, arms=again.arms, plain=again.plain)


def _with_causes(model: LinearModel, force: Unknown, best: Weighed) -> Unknown:
    """Return the unknown force, with the effects that leave too much if these fit better.

    These effects explain a part of the gap, whatever causes it. If no smooth force resembles this
    part, the scatter of a force alone would absorb it, and gap and floor would be wrong.
    """
    at = model.full.evaluate(best.at.psi, best.acting, force.best, best.forms)
    if at.value <= force.at.value:
        return force
    return replace(force, at=at, acting=best.acting, form=best.form)


def _reshaped(model: LinearModel, judged: Judged) -> Judged | None:
    """Return the causes at the shapes that leave least of the gap; None if none has a shape."""
    causes, force = judged.arms.causes, judged.posterior.force
    laws = [
        next(law for law in model.lawbook[cause.effect] if law.law == cause.law)
        for cause in causes.laws
    ]
    candidates = [model.candidate(law, 0.0) for law in laws]
    if not any(candidate.effect.shape is not None for candidate in candidates):
        return None
    nodes = [
        SHAPE_NODES if candidate.effect.shape is not None else np.zeros(1)
        for candidate in candidates
    ]
    tried = [
        replace(candidate, node=float(node))
        for candidate, places in zip(candidates, nodes, strict=True)
        for node in places
    ]
    around = model.around(model.laws, tried, discrepancy=False)
    columns = residuals_of(around, judged.arms.psi).columns[:, COEFFICIENTS:]
    own = judged.residuals.without_law(columns[:, : len(tried)])
    first = np.cumsum([0, *(places.size for places in nodes)])
    chosen = [
        int(start) + int(np.abs(places - shape).argmin())
        for start, places, shape in zip(first, nodes, causes.shapes, strict=False)
    ]

    def left(places: list[int]) -> float:
        taken = best_of(judged.residuals, own[:, places], force)
        return float(np.mean(left_of(judged.residuals, judged.posterior, taken)))

    for _ in range(PASSES if len(candidates) > 1 else 1):
        for number in range(len(candidates)):
            rivals = range(first[number], first[number + 1])
            there = [[*chosen[:number], rival, *chosen[number + 1 :]] for rival in rivals]
            chosen = min(there, key=left)
    shapes = [tried[place].node for place in chosen]
    arms = _around_causes(model, laws, shapes, causes.phases, judged.arms)
    return replace(judged, arms=arms, plain=residuals_of(arms.plain, arms.psi))


def _judged(
    model: LinearModel,
    search: Search,
    shipped: Mapping[str, Coefficients],
    practical: float,
    rng: np.random.Generator,
) -> Judged:
    best, force = search.best(), search.unknown
    mostly = search.probabilities()[UNKNOWN] >= RULES.likely
    settled = force.at if mostly and force is not None else best.at
    residuals = residuals_of(model.full, settled.psi)
    posterior = posterior_of(model, search, residuals, rng)
    effects_known = reported_effects(model, search, posterior, practical)
    above = float(np.mean(posterior.gap >= practical * residuals.friction_rms))
    named, present, possible = sort_effects(effects_known, above)
    arms = _arms(model, search, best, named, settled.psi, shipped)
    plain = residuals_of(arms.plain, arms.psi)
    return Judged(
        search,
        settled,
        residuals,
        posterior,
        effects_known,
        named,
        present,
        possible,
        arms,
        plain,
        above,
    )


def _leaves_too_much(
    judged: Judged,
    practical: float,
    own_force: Callable[[Hypothesis], Array | None] = lambda _: None,
) -> float:
    """Return the probability that the causes, if they act, leave too much of the gap.

    Parameters
    ----------
    judged : Judged
        Sorted effects.
    practical : float
        Practical share of friction.
    own_force : callable
        Function of a hypothesis that returns the forces of its effects beyond the causes, which
        count as explained; it returns None if there are none.
    """
    residuals, posterior = judged.residuals, judged.posterior
    if not judged.arms.causes.laws:
        return 0.0
    of_causes = residuals.without_law(judged.arms.of_causes(judged.plain))
    there = posterior.gap > SMALLEST * residuals.friction_rms
    drawn = posterior.hypothesis[there]
    gap = posterior.gap[there] / residuals.friction_rms
    too_much: list[Flags] = []
    for acting in dict.fromkeys(drawn.tolist()):
        if not acting.issuperset(judged.named):
            continue
        own = own_force(acting)
        shrink = shrink_of(residuals, posterior, of_causes if own is None else own)
        if shrink is None:
            continue
        left = np.clip(1 - shrink, 0.0, 1.0)
        is_beyond = (left > RULES.foreign) & (np.sqrt(left) * gap >= practical)
        too_much.append(is_beyond[drawn == acting])
    return float(np.concatenate(too_much).mean()) if too_much else 0.0


def _largest_alone(
    model: LinearModel, search: Search, judged: Judged, practical: float
) -> tuple[Hypothesis, float] | None:
    """Return the largest effects if the other effects only imitate an unknown force.

    If gravity is many times friction, all other effects are a small part of the gap. So these
    are compared with the gap that the largest effects leave. If they leave too much of it to an
    unexplained force, they imitate this force and are not causes.

    Returns
    -------
    tuple of (Hypothesis, float), or None
        The largest effects, and the probability that the others imitate; None without others.
    """
    best, residuals, posterior = search.best(), judged.residuals, judged.posterior
    names = [law.effect for law in best.acting.laws]
    drawn = posterior.hypothesis == best.hypothesis
    if len(names) < 2 or not drawn.any() or best.acting.phases:
        return None
    arms = _around_causes(model, best.acting.laws, best.acting.shapes, (), judged.arms)
    own = residuals.without_law(arms.of_causes(residuals_of(arms.plain, arms.psi)))

    def left(places: list[int]) -> Array:
        taken = best_of(residuals, own[:, places], posterior.force)
        return np.asarray((left_of(residuals, posterior, taken) + posterior.unresolved2)[drawn])

    whole = float((posterior.gap**2 + posterior.unresolved2)[drawn].mean())
    large: list[int] = []
    others = list(range(len(names)))
    while others and (not large or left(large).mean() > RULES.made_by_most * whole):
        nearest = min(others, key=lambda place: float(left([*large, place]).mean()))
        large.append(nearest)
        others.remove(nearest)
    alone = Hypothesis(names[place] for place in large)
    if not others or alone not in search.weighed:
        return None
    stays, before = left([*large, *others]), left(large)
    imitated = (stays > RULES.foreign * before) & (
        np.sqrt(stays) >= practical * residuals.friction_rms
    )
    share = float(imitated.mean())
    return (alone, share) if share >= RULES.rare else None


def _own_force(
    model: LinearModel, search: Search, judged: Judged, acting: Hypothesis
) -> Array | None:
    """Return the forces of a hypothesis' effects beyond the causes, after recalibration."""
    weighed = search.weighed.get(acting)
    if weighed is None or acting == Hypothesis(judged.named):
        return None
    causes = judged.arms.causes
    named = zip(causes.laws, causes.shapes, strict=True)
    shapes = {(law.effect, law.law): shape for law, shape in named}
    own = [
        shapes.get((law.effect, law.law), shape)
        for law, shape in zip(weighed.acting.laws, weighed.acting.shapes, strict=True)
    ]
    arms = _around_causes(model, weighed.acting.laws, own, weighed.acting.phases, judged.arms)
    return judged.residuals.without_law(arms.of_causes(residuals_of(arms.plain, arms.psi)))


def _arms(
    model: LinearModel,
    search: Search,
    best: Weighed,
    named: Collection[str],
    psi: Array,
    shipped: Mapping[str, Coefficients],
) -> Arms:
    chosen = search.weighed.get(Hypothesis(named), best)
    complete = set(shipped) >= set(model.layout.sizes)
    shipped_here = {size: shipped[size] for size in model.layout.sizes if size in shipped}
    without = Arms(
        model, model, psi[: len(model.noise)], Acting(), shipped_here if complete else None
    )
    return arms_with(model, chosen, named, without)


def arms_with(model: LinearModel, weighed: Weighed, names: Collection[str], like: Arms) -> Arms:
    """Return the law without and with some effects of a hypothesis.

    Parameters
    ----------
    model : LinearModel
        The model in which the hypotheses were compared.
    weighed : Weighed
        The hypothesis, with the laws and shapes of its effects.
    names : collection of str
        The effects of it that predict.
    like : Arms
        Contains the noise parameters and the shipped values.
    """
    acting = weighed.acting
    own = [
        (law, shape)
        for law, shape in zip(acting.laws, acting.shapes, strict=True)
        if law.effect in names
    ]
    laws, shapes = [law for law, _ in own], [shape for _, shape in own]
    phases = tuple(law for law in acting.phases if law.effect in names)
    return _around_causes(model, laws, shapes, phases, like)


def _around_causes(
    model: LinearModel,
    laws: Sequence[Law],
    shapes: Sequence[float],
    phases: tuple[Law, ...],
    like: Arms,
) -> Arms:
    """Return the law without and with causes, at the noise parameters of other arms."""
    own = [model.candidate(law, shape) for law, shape in zip(laws, shapes, strict=True)]
    plain = model.around(model.laws, own, discrepancy=False)
    acting = tuple(
        Law(law.effect, law.law, (place,), (shape,), 0.0)
        for place, (law, shape) in enumerate(zip(laws, shapes, strict=True))
    )
    return replace(like, plain=plain, causes=Acting(acting, tuple(shapes), phases))

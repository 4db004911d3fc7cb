"""Searches for the effects that act: hypotheses with none or more effects, or an unknown force.

All listed hypotheses are evaluated in the same model, each with the noise at its own mode. The
search adds effects to the best hypotheses. The evidence of a hypothesis that was only screened is a
lower bound.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np
from scipy.special import logsumexp

from bayesfric.arrays import Array
from bayesfric.diagnosis.acting import Acting
from bayesfric.diagnosis.classes import Classes
from bayesfric.diagnosis.climbing import curvature_at
from bayesfric.diagnosis.discrepancy import relative_rms
from bayesfric.diagnosis.forms import AS_IT_IS, FormShare
from bayesfric.diagnosis.hypotheses import Search
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.shapes import Quadratic
from bayesfric.diagnosis.unknown import Unknown
from bayesfric.diagnosis.weighing import FORM_SHARES, Weighed, log_volume
from bayesfric.diagnosis_rules import RULES
from bayesfric.hypothesis import NONE, Hypothesis

NEAR = 3.0  # a start is tried if it is at most this far below a known mode [nat]


class Steps(NamedTuple):
    """The slow steps of a search, whose results may come from a checkpoint."""

    weigh: Callable[..., Weighed]
    unknown_force: Callable[..., Unknown | None]

    def weigh_in(self, model: LinearModel, searched: Search, *asked: Any, **how: Any) -> Weighed:
        """Evaluate a hypothesis, with the noise volume and inverse curvature of the search."""
        return self.weigh(model, *asked, searched.inverse, searched.volume, **how)


def search(
    model: LinearModel,
    none: Weighed,
    inverse: Array,
    volume: float,
    classes: Classes,
    steps: Steps,
) -> Search:
    """Search for effects that act, starting from none.

    Parameters
    ----------
    model : LinearModel
        The model with every candidate.
    none : Weighed
        The hypothesis without effects.
    inverse : ndarray
        Inverse curvature of the log density in its log noise parameters.
    volume : float
        Log Laplace volume of its noise.
    classes : Classes
        Effects that are examined, in classes.
    steps : Steps
        Functions that evaluate hypotheses.
    """
    priors = model.analysis.diagnosis.hypotheses
    searched = Search({NONE: none}, {}, None, classes, priors, inverse, volume)
    effects = sorted(members[0] for members in classes.members)
    shapes = _weigh_alone(model, searched, effects, steps)
    _weigh_together(model, searched, effects, shapes, steps)
    _weigh_parts(model, searched, steps)
    unknown = steps.unknown_force(model, searched.none, Acting(), inverse, volume)
    return replace(searched, unknown=unknown, nothing_varied=unknown is None)


def _weigh_alone(
    model: LinearModel, searched: Search, effects: Sequence[str], steps: Steps
) -> dict[str, float]:
    """Evaluate each effect alone, and return the best shapes of its laws."""
    none = leader = searched.none
    quiet = model.noise.quiet(none.at.psi)
    shapes: dict[str, float] = {}
    rough = _extended(model, none, effects, none.at.psi, shapes)
    for alone in sorted(rough, key=lambda alone: -rough[alone]):
        starts = [none.at.psi]
        if rough[alone] > none.log_evidence + RULES.effect_gains:
            starts.append(quiet)
        starts.append(leader.at.psi)
        weighed = steps.weigh_in(model, searched, alone.names, starts, shapes=shapes)
        searched.weighed[alone] = weighed
        if weighed.log_evidence > leader.log_evidence:
            leader = weighed
        shapes |= _shapes_of(weighed)
    if leader.log_evidence > none.log_evidence + RULES.weighed_within:
        _weigh_at_noise_of(model, searched, leader, steps)
    return shapes


def _weigh_at_noise_of(model: LinearModel, searched: Search, leader: Weighed, steps: Steps) -> None:
    """Evaluate single effects again from the leader's noise, if it is nearly as probable for them.

    Scatter may have absorbed what an effect does. With less scatter they look different.
    """
    for alone, weighed in list(searched.weighed.items()):
        if alone in (NONE, leader.hypothesis):
            continue
        there = np.append(leader.at.psi[: len(model.noise)], weighed.at.psi[len(model.noise) :])
        if model.evaluate(there, weighed.acting).value < weighed.at.value - NEAR:
            continue
        shapes = _shapes_of(weighed)
        again = steps.weigh_in(model, searched, weighed.names, [leader.at.psi], shapes=shapes)
        if again.log_evidence > weighed.log_evidence:
            searched.weighed[alone] = again


def _weigh_together(
    model: LinearModel,
    searched: Search,
    effects: Sequence[str],
    shapes: dict[str, float],
    steps: Steps,
) -> None:
    """Evaluate sets of two and more effects, each an extension of the best smaller sets."""
    for number in range(2, RULES.most_effects + 1):
        fewer = [
            weighed for weighed in searched.weighed.values() if len(weighed.names) == number - 1
        ]
        fewer = sorted(fewer, key=lambda weighed: -searched.worth(weighed))
        top = max(searched.worth(weighed) for weighed in searched.weighed.values())
        grown = False
        for base in fewer[: RULES.beam if number > 2 else 2]:
            if searched.worth(base) < top - 2 * RULES.weighed_within and number > 2:
                continue
            joining = _that_may_act(base, effects, searched.classes)
            rough = _extended(model, base, joining, base.at.psi, shapes)
            for more, first_look in rough.items():
                searched.rough.setdefault(more, first_look)
            for more in sorted(rough, key=lambda more: -rough[more])[: RULES.tried]:
                worth = rough[more] + searched.log_prior(more)
                if more in searched.weighed or worth < top - RULES.weighed_within:
                    continue
                if rough[more] < base.log_evidence + RULES.effect_gains:
                    continue
                starts = [base.at.psi]
                weighed = steps.weigh_in(model, searched, more.names, starts, shapes=shapes)
                searched.weighed[more] = weighed
                grown |= searched.worth(weighed) > top
                top = max(top, searched.worth(weighed))
        if not grown and number > 2:
            return


def _weigh_parts(
    model: LinearModel, searched: Search, steps: Steps, forms: Sequence[FormShare] = (AS_IT_IS,)
) -> None:
    """Evaluate the leader without each of its effects, again if such a part then leads.

    The search may have missed them: a curve along speed that imitates two effects can enter
    first, and is not needed any more after both effects. Each effect of a ladder is also replaced
    by the others of the ladder.
    """
    while True:
        best = searched.best()
        parts = [Hypothesis(best.hypothesis - {name}) for name in best.names]
        parts += [Hypothesis(names) for names in searched.classes.other_rungs(best.names)]
        missing = [part for part in parts if part and part not in searched.weighed]
        if not missing:
            return
        how = {"shapes": _shapes_of(best), "forms": forms}
        for part in missing:
            starts = [best.at.psi, searched.none.at.psi]
            searched.weighed[part] = steps.weigh_in(model, searched, part.names, starts, **how)


def compare(model: LinearModel, first: Search, steps: Steps) -> Search:
    """Evaluate the finalists again, in one model around the leader, with the forms of their laws.

    Parameters
    ----------
    model : LinearModel
        Model around the law fitted with the leading hypothesis, with the finalists' forms.
    first : Search
        Hypotheses in the model around the baseline.
    steps : Steps
        Functions that evaluate hypotheses.
    """
    leader = first.best()
    result = _weigh_finalists(model, first, leader, steps)
    _weigh_beside_best(model, result, steps)
    # Screened hypotheses keep their distance from the former leader, at its new evidence.
    level = result.weighed[leader.hypothesis].log_evidence - leader.log_evidence
    screened = first.rough | {acting: rival.log_evidence for acting, rival in first.weighed.items()}
    rough = {
        acting: value + min(level, 0.0)
        for acting, value in screened.items()
        if acting not in result.weighed
    }
    return _with_unknown_force(model, replace(result, rough=rough), leader, steps)


def _weigh_finalists(model: LinearModel, first: Search, leader: Weighed, steps: Steps) -> Search:
    """Evaluate the finalists in a model, with all forms of their laws."""
    none = steps.weigh(
        model, (), [first.none.at.psi, leader.at.psi], first.inverse, 0.0, own_volume=False
    )
    curvature = curvature_at(model, none.at, Acting())
    inverse = np.asarray(np.linalg.inv(curvature), dtype=np.float64)
    volume = log_volume(curvature)
    none = replace(none, log_evidence=none.log_evidence + volume, curvature=curvature)
    compared: dict[Hypothesis, Weighed] = {NONE: none}
    for finalist in (first.weighed[hypothesis] for hypothesis in _finalists(first)):
        if not finalist.names:
            continue
        again = steps.weigh(
            model,
            finalist.names,
            [finalist.at.psi, leader.at.psi[: len(model.noise)]],
            inverse,
            volume,
            shapes=_shapes_of(finalist),
            forms=FORM_SHARES,
            own_volume=has_own_noise_volume(first, finalist),
        )
        compared[finalist.hypothesis] = again
        if finalist.hypothesis == leader.hypothesis and again.volume is not None:
            # Hypotheses with the leader's effects have its noise volume. Without these
            # effects the noise is larger and better determined.
            volume = again.volume
    return Search(compared, {}, None, first.classes, first.priors, inverse, volume)


def _weigh_beside_best(model: LinearModel, result: Search, steps: Steps) -> None:
    """Evaluate the best with one more effect, which an error of a law may have imitated."""
    best = result.best()
    if not best.names or len(best.names) >= RULES.most_effects:
        return
    effects = sorted(members[0] for members in result.classes.members)
    joining = _that_may_act(best, effects, result.classes)
    rough = _extended(model, best, joining, best.at.psi, {}, forms=best.forms)
    for more in sorted(rough, key=lambda more: -rough[more])[: RULES.tried]:
        if more in result.weighed or rough[more] < best.log_evidence + RULES.effect_gains:
            continue
        how = {"shapes": _shapes_of(best), "forms": FORM_SHARES}
        result.weighed[more] = steps.weigh_in(model, result, more.names, [best.at.psi], **how)
    _weigh_parts(model, result, steps, FORM_SHARES)
    _weigh_exchanged(model, result, steps)


def _weigh_exchanged(model: LinearModel, result: Search, steps: Steps) -> None:
    """Evaluate the best with one of its effects exchanged for another.

    The first look at a pair is taken at the noise of one of its effects. It may be hundreds of nats
    too low, and more so for one of two effects that explain the same force. At the noise of the
    best both look alike.
    """
    best = result.best()
    effects = sorted(members[0] for members in result.classes.members)
    how = {"shapes": _shapes_of(best), "forms": FORM_SHARES}
    for name in best.names:
        part = result.weighed.get(Hypothesis(best.hypothesis - {name}))
        if part is None or not part.names:  # effects alone were all evaluated
            continue
        psi = best.at.psi if part.at.psi.size == best.at.psi.size else part.at.psi
        joining = _that_may_act(part, effects, result.classes)
        rough = _extended(model, part, joining, psi, {}, forms=best.forms)
        level = best.log_evidence - rough.pop(best.hypothesis)
        least = result.worth(best) - RULES.weighed_within
        for rival in sorted(rough, key=lambda rival: -rough[rival])[: RULES.tried]:
            if rival in result.weighed or level + rough[rival] + result.log_prior(rival) < least:
                continue
            result.weighed[rival] = steps.weigh_in(model, result, rival.names, [psi], **how)


def _with_unknown_force(
    model: LinearModel, result: Search, leader: Weighed, steps: Steps
) -> Search:
    """Add an unknown force to the hypotheses, alone or with the effects of the best."""
    best, inverse, volume = result.best(), result.inverse, result.volume
    noise, near = leader.at.psi[: len(model.noise)], best.log_evidence - RULES.followed_within
    unknown = steps.unknown_force(model, result.none, Acting(), inverse, volume, [noise], near)
    if best.names and unknown is not None:
        beside = steps.unknown_force(model, best, best.acting, inverse, volume, (), near)
        if beside is not None and _outweighs(model, beside, best):
            return result.with_unknown(unknown, beside, best.hypothesis)
    return replace(result, unknown=unknown, nothing_varied=unknown is None)


def _outweighs(model: LinearModel, unknown: Unknown, best: Weighed) -> bool:
    """Return whether an unknown force is larger than all effects that act with it."""
    rows = [rig.rows for rig in model.rigs]
    sizes = [
        relative_rms(rows, candidate) * value
        for candidate, value in model.amplitudes(best.at, best.acting)
    ]
    amplitudes = np.exp(best.at.psi[len(model.noise) :])
    sizes += [
        relative_rms(rows, model.candidates[law.places[0]]) * value
        for law, value in zip(best.acting.phases, amplitudes, strict=True)
    ]
    return unknown.best.share > float(np.linalg.norm(sizes))


def has_own_noise_volume(first: Search, weighed: Weighed) -> bool:
    """Return whether a hypothesis is probable enough to get its own noise volume."""
    return first.worth(weighed) > first.worth(first.best()) - RULES.own_noise_within


def _finalists(first: Search) -> list[Hypothesis]:
    """Return the hypotheses of the final comparison, the best first."""
    ranked = sorted(first.weighed.values(), key=lambda weighed: -first.worth(weighed))
    best = ranked[0]
    top = first.worth(best)
    chosen = [
        rival.hypothesis
        for rival in ranked[: RULES.finalists]
        if first.worth(rival) > top - RULES.compared_within
    ]
    # Each subset of the leader: a cause is compared with the best hypothesis without it.
    for number in range(1, len(best.names)):
        parts = map(Hypothesis, combinations(best.names, number))
        chosen += [part for part in parts if part in first.weighed]
    return list(dict.fromkeys(chosen))


def _that_may_act(base: Weighed, effects: Sequence[str], classes: Classes) -> list[str]:
    """Return the effects of a hypothesis, and those that may act together with them."""
    return [
        name
        for name in effects
        if name in base.names or classes.may_act_together((*base.names, name))
    ]


def _extended(
    model: LinearModel,
    base: Weighed,
    effects: Sequence[str],
    psi: Array,
    shapes: dict[str, float],
    forms: Mapping[str, FormShare] | None = None,
) -> dict[Hypothesis, float]:
    """Screen hypotheses with one more effect, at the noise of the base.

    The best shapes are added to `shapes` where it has none yet.
    """
    with_columns = [
        name
        for name in effects
        if not model.candidates[model.lawbook[name][0].places[0]].effect.components
    ]
    acting = Acting(phases=base.acting.phases)
    places = [p for name in with_columns for law in model.lawbook[name] for p in law.places]
    reduced = model.reduced(psi, acting, forms, places)
    quadratic = Quadratic(model, reduced, places)
    held = 0.0
    if base.acting.laws:
        shapes_held = [np.array([s]) for s in base.acting.shapes]
        held = float(quadratic.values(base.acting.laws, shapes_held)[0])
    extended: dict[Hypothesis, float] = {}
    for name in with_columns:
        if name in base.names:
            continue
        values = []
        for law in model.lawbook[name]:
            laws = (*base.acting.laws, law)
            key = f"{law.effect}:{law.law}"
            at = [*base.acting.shapes, shapes.get(key, 0.0)]
            if law.has_shape:
                shape, gain, _ = quadratic.along(laws, at, len(laws) - 1)
                if not base.names:
                    shapes[key] = shape
            else:
                gain = float(quadratic.values(laws, [np.array([s]) for s in at])[0])
            values.append(gain - held + law.log_weight)
        extended[base.hypothesis.with_effects(name)] = base.log_evidence + float(logsumexp(values))
    for name in set(effects) - set(with_columns) - set(base.names):
        law = model.lawbook[name][0]
        both = Acting(base.acting.laws, base.acting.shapes, (*base.acting.phases, law))
        scale = model.amplitude_scale(law)
        tried = [
            model.evaluate(np.append(psi, np.log(share * scale)), both, None, forms).value
            for share in (0.03, 0.1, 0.3, 1.0)
        ]
        extended[base.hypothesis.with_effects(name)] = (
            base.log_evidence + max(tried) - base.at.value
        )
    return extended


def _shapes_of(weighed: Weighed) -> dict[str, float]:
    return {
        f"{law.effect}:{law.law}": shape
        for choice in weighed.choices[::-1]
        for law, shape in zip(choice.laws, choice.shapes, strict=True)
    }

"""Widens priors of amplitudes that are so tight that they would make a second effect a cause.

The evidence of a hypothesis falls with the squared distance of an amplitude from the centre of its
prior. If a second effect has nearly the same response, both effects together need smaller
amplitudes. The prior, and not the data, then names the second effect. If a hypothesis without it
would be as likely with wider priors, these priors are widened.
"""

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from bayesfric.analysis import LogNormal, Prior
from bayesfric.arrays import Array
from bayesfric.diagnosis.compared import Compared
from bayesfric.diagnosis.hypotheses import Search
from bayesfric.diagnosis.judging import Judged
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.question import Question
from bayesfric.diagnosis.verdict import decide
from bayesfric.diagnosis.weighing import Weighed
from bayesfric.diagnosis_rules import RULES
from bayesfric.effects import Effect
from bayesfric.effects.candidates import prior_moments
from bayesfric.hypothesis import Hypothesis
from bayesfric.inference.priors import describe


def too_tight(question: Question, compared: Compared, judged: Judged) -> tuple[str, ...]:
    """Return the effects whose tight priors may be the only reason for a cause.

    The amplitude of such an effect is beyond its prior in the best hypothesis with all causes,
    or in a hypothesis without one of them that could be as likely with wider priors. Priors
    that the user stated are not changed.

    Parameters
    ----------
    question : Question
        What is asked.
    compared : Compared
        Hypotheses, compared with the present priors.
    judged : Judged
        Which effects are causes.
    """
    chances = judged.search.probabilities()
    causes = [effect for effect in judged.effects_known if effect.effect in judged.named]
    if decide(chances, causes, judged.above, ())[0] != "named":
        return ()
    named = Hypothesis(judged.named)
    analysis = question.analysis
    stated = {*analysis.priors.effects, *analysis.diagnosis.widths, *question.widened}
    searches = ((compared.baseline, compared.first), (compared.model, judged.search))
    tight = {
        name for model, search in searches for name in _of_rivals(model, search, named, stated)
    }
    return tuple(sorted(tight))


def with_wider_priors(question: Question, names: Collection[str], judged: Judged) -> Question:
    """Return the question with wider priors of the named effects, and a remark about it.

    Parameters
    ----------
    question : Question
        What is asked.
    names : collection of str
        Effects, as of :func:`too_tight`.
    judged : Judged
        Effects, sorted with the present priors.
    """
    causes = " and ".join(judged.named)
    examined, remarks = dict(question.examined), list(question.remarks)
    for name in names:
        effect = examined[name]
        prior = effect.amplitude.prior
        wide = prior.widened(RULES.wider)
        examined[name] = replace(effect, amplitude=replace(effect.amplitude, prior=wide))
        remarks.append(_remark(effect, causes))
    widened = (*question.widened, *names)
    return replace(question, examined=examined, remarks=tuple(remarks), widened=widened)


def _remark(effect: Effect, causes: str) -> str:
    amplitude = effect.amplitude
    return (
        f"These data may have {effect.name} beyond its prior ({amplitude.name} "
        f"{describe(amplitude.prior)} {amplitude.unit}), with which {causes} would be named. "
        f"Hypotheses are compared with a prior {RULES.wider:g} times as wide; a prior of your own, "
        f"priors.effects.{effect.name} in analysis.toml, stands"
    )


def _of_rivals(
    model: LinearModel, search: Search, named: Hypothesis, stated: Collection[str]
) -> set[str]:
    """Return effects beyond their priors in hypotheses that lack a cause and may be as likely."""
    weighed = search.weighed.values()
    standing = [rival for rival in weighed if named <= rival.hypothesis]
    if not standing:
        return set()
    best = max(standing, key=search.worth)
    noise = best.at.psi[: len(model.noise)]
    of_best, best_gain = _gained(model, best, noise, stated)
    least = search.worth(best) + max(best_gain, 0.0)
    least -= float(np.log(RULES.sure / (1 - RULES.sure)))
    tight: set[str] = set()
    for rival in weighed:
        if not named <= rival.hypothesis:
            names, gain = _gained(model, rival, noise, stated)
            if names and search.worth(rival) + gain >= least:
                # A cause beyond its own prior must not lose evidence by that.
                tight |= names | of_best
    return tight


def _gained(
    model: LinearModel, weighed: Weighed, noise: Array, stated: Collection[str]
) -> tuple[set[str], float]:
    """Return effects beyond their priors, and the gain in log evidence by wider priors.

    The noise parameters are those of the hypothesis, or `noise` if that is better: scatter may
    have absorbed what the tight priors kept from the effects.
    """
    beyond = np.array(_beyond(model, weighed, stated), dtype=bool)
    if not beyond.any():
        return set(), 0.0
    laws, forms = weighed.acting.laws, weighed.forms
    effects = [model.candidates[law.places[0]].effect for law in laws]
    mean, sd = model.prior([model.amplitude_prior(law) for law in laws], None, forms)
    wide = sd.copy()
    wide[model.places(len(laws))[beyond]] *= RULES.wider
    there = np.concatenate([noise, weighed.at.psi[noise.size :]])
    gains = []
    for at in (weighed.at, model.evaluate(there, weighed.acting, None, forms)):
        more = at.information.integrated(mean, wide)[0] - at.information.integrated(mean, sd)[0]
        gains.append(at.value + more - weighed.at.value)
    names = {effect.name for effect, is_beyond in zip(effects, beyond, strict=True) if is_beyond}
    return names, max(gains)


def _beyond(model: LinearModel, weighed: Weighed, stated: Collection[str]) -> list[bool]:
    """Return for each law with a column whether its amplitude is beyond its prior."""
    means = weighed.at.mean[model.places(len(weighed.acting.laws))]
    beyond = []
    for law, mean in zip(weighed.acting.laws, means, strict=True):
        effect = model.candidates[law.places[0]].effect
        centre, sd = prior_moments(effect.amplitude.prior)
        is_free = effect.name not in stated and _has_width(effect.amplitude.prior)
        beyond.append(is_free and abs(float(mean) - centre / sd) > RULES.beyond_prior)
    return beyond


def _has_width(prior: Prior) -> bool:
    """Return whether a prior has a width that can be increased around the same centre."""
    return prior.width is not None and not isinstance(prior, LogNormal)

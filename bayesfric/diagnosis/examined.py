"""Which effects are examined, and the stored entry of each."""

from collections.abc import Collection, Mapping
from dataclasses import replace

import numpy as np

from bayesfric.analysis import Analysis, Prior, Priors
from bayesfric.diagnosis.hypotheses import Search
from bayesfric.effects import Effect, all_effects
from bayesfric.effects.in_the_model import IN_THE_MODEL
from bayesfric.errors import Fault, InputError
from bayesfric.hypothesis import Hypothesis
from bayesfric.inference.priors import from_normal
from bayesfric.probabilities import LN10
from bayesfric.rigs.base import RigTrials
from bayesfric.rigs.data import Data
from bayesfric.schemas.diagnosis import ExaminedEffect

NARROW = 1e-3  # of the usual width; a narrower prior determines a number instead of the data
APART = "a model of the machine, or other joints that are still"


def examinable(
    data: Data, own: Mapping[str, Effect]
) -> tuple[dict[str, Effect], dict[str, tuple[str, ...]]]:
    """Return the effects that the rigs can have, in their units, and what other effects lack.

    A user's effect is in the user's units already; an effect on several rigs keeps the units
    of its description.
    """
    offered: frozenset[str] = frozenset().union(*(rig.offers for rig in data.rigs))
    taken = frozenset().union(*(trials.covered_effects for trials in data.rigs)) - frozenset(own)
    examined: dict[str, Effect] = {}
    lacking: dict[str, tuple[str, ...]] = {}
    for name, effect in sorted({**all_effects(None), **own}.items()):
        if missing := effect.needs - offered:
            lacking[name] = tuple(sorted(missing))
        elif name in taken:
            lacking[name] = (APART,)
        elif name in own or len(data.rigs) > 1:
            examined[name] = effect
        else:
            examined[name] = data.rigs[0].suited(effect)
    return examined, lacking


def no_effects(data: Data, own: Collection[str]) -> dict[str, str]:
    """Return effects that are part of the model of these rigs, by name, with the reason."""
    joints = any(rig.other_joints is not None for rig in data.rigs)
    return {name: why for name, why in IN_THE_MODEL.items() if joints and name not in own}


def widened(effect: Effect, analysis: Analysis) -> Effect:
    """Return an effect with the user's width of its amplitude's prior."""
    factor = analysis.diagnosis.widths.get(effect.name, 1.0)
    prior = effect.amplitude.prior
    if factor == 1.0:
        return effect
    if prior.width is None:
        raise InputError(
            [Fault("analysis.toml", "an effect whose prior has a width", column=effect.name)]
        )
    return replace(effect, amplitude=replace(effect.amplitude, prior=prior.widened(factor)))


def remarks_on_priors(
    analysis: Analysis, effects: Mapping[str, Effect], rig: RigTrials
) -> tuple[str, ...]:
    """Return a sentence for each of the user's priors that has no effect, or overrides the data.

    Parameters
    ----------
    analysis : Analysis
        The user's analysis.
    effects : mapping of str to Effect
        Examined effects with their priors.
    rig : RigTrials
        The first rig, whose law may have priors in the machine's units.
    """
    priors, lines = analysis.priors, []
    usual: dict[str, Prior] = {
        name: getattr(Priors(), name) for name in ("c1", "c2") if name in priors.model_fields_set
    }
    for own in rig.own_priors.values():
        usual |= {name: prior for name in usual if (prior := getattr(own, name)) is not None}
    stated = [(f"priors.{name}", getattr(priors, name), prior) for name, prior in usual.items()]
    for name, chosen in priors.effects.items():
        if name not in effects:
            lines.append(f"priors.effects.{name} does nothing: the effect is not examined here")
            continue
        stated += [
            (f"priors.effects.{name}.{parameter.name}", chosen[parameter.name], parameter.prior)
            for parameter in effects[name].parameters
            if parameter.name in chosen
        ]
    for name, prior, other in stated:
        share = _width(prior) / _width(other)
        if share < NARROW:
            lines.append(
                f"{name} is {share:.1g} times as wide as it is without your analysis: the prior "
                "decides the number, and the data do not (is it in another unit?)"
            )
    return tuple(lines)


def _width(prior: Prior) -> float:
    low, high = from_normal(prior, np.array([-1.0, 1.0]))
    return float(high - low)


def examined_effects(
    first: Search,
    names: list[str],
    lacking: Mapping[str, tuple[str, ...]],
    elsewhere: Mapping[str, str],
) -> tuple[ExaminedEffect, ...]:
    """Return the entry of each effect: its Bayes factor against the baseline, or why it has none.

    `elsewhere` contains effects that are part of the model, with the reason. All Bayes factors
    are from the model around the baseline, in which every effect was evaluated. Evidences from
    the model around the leader's law, which contains only finalists, are not comparable.
    """
    absorbed = {effect.effect for effect in first.classes.absorbed}
    stands = {name: members[0] for members in first.classes.members for name in members}
    listed = []
    for name in sorted({*names, *elsewhere}):
        value, bound = None, False
        why, needs = first.classes.left_out.get(name), lacking.get(name, ())
        if needs:
            why = f"absent from these data: it needs what no rig here has ({', '.join(needs)})"
        if name in elsewhere:
            why = elsewhere[name]
        elif name in absorbed:
            why = "it only shifts a parameter of the baseline"
        elif name in stands:
            own = first.weighed[Hypothesis((stands[name],))]
            value = (own.log_evidence - first.none.log_evidence) / LN10
            bound = own.bound
        listed.append(
            ExaminedEffect(
                effect=name,
                log10_bayes_factor=value,
                log10_bayes_factor_why=why,
                bound=bound,
                needs=needs,
            )
        )
    return tuple(listed)

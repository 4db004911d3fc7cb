"""Which effect causes the gap: probabilities of none, one, two, more, and of none of these."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import combinations
from math import comb

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp
from scipy.stats import halfnorm

from bayesfric.diagnosis.classes import Classes, classes_of
from bayesfric.diagnosis.discrepancy import Wide
from bayesfric.diagnosis.forms import SHARES
from bayesfric.diagnosis.linear_model import Acting, LinearModel
from bayesfric.diagnosis.weighing import Weighed, combine, weigh

__all__ = [
    "NONE",
    "PRIOR",
    "UNKNOWN",
    "Unknown",
    "Which",
    "label",
    "look_closer",
    "unknown_evidence",
    "which_effect",
]

Array = NDArray[np.float64]
NONE, UNKNOWN = "none", "unknown"
PRIOR = {"none": 0.5, "one": 0.3, "two": 0.08, "more": 0.02, "unknown": 0.1}
"""Prior probabilities by number of effects, shared equally within a number."""
UNKNOWN_SCALE = 0.1  # of rms friction: of the half-normal of an unknown force's rms
UNKNOWN_NODES = np.linspace(0.05, 0.95, 10)  # quantiles of that half-normal
FINALISTS = 10  # pairs that are weighed with all laws and shapes
NEAR = 4.0  # nat from the best, of a hypothesis whose noise is integrated over
WITHIN = 7.0  # nat from the best, prior included, of a pair that is worth it
GAIN = 1.0  # nat that an effect adds, from which on the noise is looked at anew
WORTH = 3.0  # nat that a further effect has to gain, beyond two
MOST = 4  # effects at a time
CLOSE = 30.0  # nat from the best, of a part of the causes whose noise is looked at anew
LISTED = 1e-6  # probability below which a hypothesis is not listed


@dataclass(frozen=True)
class Unknown:
    """A smooth force that nobody named, weighed.

    Parameters
    ----------
    nodes : tuple of Wide
        How large it may be, and along which axes.
    log_weights : ndarray
        Of each node, normalised.
    log_evidence : float
        Without the volume of the noise's mode.
    psi : ndarray
        Logarithms of the noise with it.
    """

    nodes: tuple[Wide, ...]
    log_weights: Array
    log_evidence: float
    psi: Array


@dataclass(frozen=True)
class Which:
    """Hypotheses weighed.

    Parameters
    ----------
    log_evidence : dict of str to float
        Of each hypothesis that was weighed.
    weighed : dict of str to Weighed
        Named ones and ``none``.
    classes : Classes
        What is identical, absorbed or left out.
    unknown : Unknown or None
        An unknown force; None where it was not weighed.
    screened : frozenset of str
        Hypotheses whose evidence is that at another one's noise, laws and shapes.
    error : float
        Of a difference of log evidences: by how much the noise's volume moves them.
    representative : dict of str to str
        The member that stands for each effect's class.
    """

    log_evidence: dict[str, float]
    weighed: dict[str, Weighed]
    classes: Classes
    unknown: Unknown | None
    screened: frozenset[str]
    error: float
    representative: dict[str, str] = field(default_factory=dict)

    def log_prior(self, name: str, none: float = PRIOR["none"]) -> float:
        """Return the log prior probability of a hypothesis, with another one of none."""
        rest = (1 - none) / (1 - PRIOR["none"])
        if name == NONE:
            return float(np.log(none))
        if name == UNKNOWN:
            return float(np.log(rest * PRIOR["unknown"]))
        count, number = len(self.classes.members), _count(name)
        mass = PRIOR[{1: "one", 2: "two"}.get(number, "more")]
        return float(np.log(rest * mass / comb(count, number)))

    def probabilities(self, none: float = PRIOR["none"]) -> dict[str, float]:
        """Return posterior probabilities, the largest first, summing to 1."""
        names = list(self.log_evidence)
        values = np.array([self.log_evidence[n] + self.log_prior(n, none) for n in names])
        chances = dict(zip(names, np.exp(values - logsumexp(values)), strict=True))
        listed = {n for n, chance in chances.items() if chance > LISTED} | {NONE, UNKNOWN}
        ranked = sorted(listed, key=lambda name: (-chances[name], name))
        total = sum(chances[name] for name in ranked)
        return {name: float(chances[name] / total) for name in ranked}

    def unvisited(self) -> float:
        """Return the probability of hypotheses that were screened only."""
        chances = self.probabilities()
        return float(sum(chances.get(name, 0.0) for name in sorted(self.screened)))


def label(names: tuple[str, ...]) -> str:
    """Return the name of a joint hypothesis."""
    return "+".join(sorted(names)) if names else NONE


def which_effect(model: LinearModel, psi: Array) -> Which:
    """Weigh all hypotheses.

    Parameters
    ----------
    model : LinearModel
        The boards with every candidate.
    psi : ndarray
        Logarithms of the noise under the baseline alone.
    """
    classes = classes_of(model, psi)
    none = weigh(model, (), psi)
    weighed: dict[str, Weighed] = {NONE: none}
    every = [weigh(model, (name,), psi, climb=False) for m in classes.members for name in m]
    singles: dict[str, Weighed] = {}
    for one in every:
        # Where an effect gains nothing, the noise is what it was.
        gains = one.log_evidence > none.log_evidence + GAIN
        singles[one.names[0]] = weigh(model, one.names, psi) if gains else one
    log_evidence = {NONE: none.log_evidence}
    representative: dict[str, str] = {}
    for members in classes.members:
        best = max(members, key=lambda name: (singles[name].log_evidence, name))
        values = [singles[name].log_evidence for name in members]
        weighed[best] = singles[best]
        log_evidence[best] = float(logsumexp(values) - np.log(len(values)))
        representative |= dict.fromkeys(members, best)
    effects = sorted(set(representative.values()))
    screened = _pairs(model, effects, weighed, log_evidence)
    _further(model, effects, weighed, log_evidence)
    unknown = unknown_evidence(model, psi, Acting())
    log_evidence[UNKNOWN] = unknown.log_evidence
    error = _volumes(model, weighed, log_evidence)
    return Which(
        log_evidence,
        weighed,
        classes,
        unknown,
        screened,
        error,
        representative,
    )


def look_closer(model: LinearModel, which: Which, found: Weighed) -> Which:
    """Weigh the leading hypothesis and its neighbours again, around itself.

    Where an effect acts, its force scatters with friction. That is known once its size
    is, and without it a large effect's scatter passes for a small effect more. So does the
    difference between an effect's law and another form of it.

    Parameters
    ----------
    model : LinearModel
        Around the law fitted with the causes, what they add scattering with it.
    which : Which
        All hypotheses, weighed around the baseline.
    found : Weighed
        The leading one.

    Returns
    -------
    Which
        With new values for the causes, each part of them, and each effect beside them.
    """
    again: dict[str, Weighed] = {}

    def worth(one: Weighed) -> float:
        prior = PRIOR[{1: "one", 2: "two"}.get(len(one.names), "more")]
        count = comb(len(which.classes.members), len(one.names))
        return one.log_evidence + float(np.log(prior / count))

    for number in range(1, len(found.names) + 1):
        for names in combinations(found.names, number):
            again[label(names)] = weigh(model, names, found.psi, climb=False, shares=SHARES)
    top = max(worth(one) for one in again.values())
    for name, one in again.items():
        if worth(one) > top - CLOSE or len(one.names) >= len(found.names) - 1:
            again[name] = weigh(model, one.names, found.psi, shares=SHARES)
    best = max(again.values(), key=worth)
    # Neighbours are compared with each other. With all else they are compared by the leader as
    # it was: what forms gain is nothing against a force that nobody named.
    leading = label(found.names)
    level = which.log_evidence[leading] - max(best.log_evidence, again[leading].log_evidence)
    effects = sorted(set(which.representative.values()))
    while True:
        beside = {}
        for name in effects:
            names = tuple(sorted({*best.names, name}))
            if name in best.names or len(names) > MOST or label(names) in again:
                continue
            one = weigh(model, names, best.psi, climb=False, shares=SHARES)
            if one.log_evidence > best.log_evidence + GAIN:
                one = weigh(model, names, best.psi, shares=SHARES)
            beside[label(names)] = one
        again |= beside
        better = max(beside.values(), key=worth, default=best)
        if worth(better) <= worth(best):
            break
        best = better
    values = {name: one.log_evidence + level for name, one in again.items()}
    return replace(
        which,
        log_evidence=which.log_evidence | values,
        weighed=which.weighed | again,
        screened=which.screened - set(again),
    )


def _pairs(
    model: LinearModel,
    effects: list[str],
    weighed: dict[str, Weighed],
    log_evidence: dict[str, float],
) -> frozenset[str]:
    """Weigh the promising pairs, screen the others; return these."""
    if len(effects) < 2:
        return frozenset()
    singles = {name: weighed[name] for name in effects}
    best = max(singles.values(), key=lambda one: one.log_evidence)
    psi = best.psi if best.log_evidence > weighed[NONE].log_evidence else weighed[NONE].psi
    rough = _rough_pairs(model, singles, effects, psi)
    pairs, ones = len(rough), len(effects)
    prior = {0: PRIOR["none"], 1: PRIOR["one"] / ones, 2: PRIOR["two"] / pairs}
    before = {name: value + np.log(prior[_count(name)]) for name, value in log_evidence.items()}
    top = max(*before.values(), *(value + np.log(prior[2]) for value in rough.values()))
    screened = {label(pair) for pair in rough}
    for place, pair in enumerate(sorted(rough, key=lambda pair: -rough[pair])):
        name = label(pair)
        log_evidence[name] = rough[pair]
        if place < FINALISTS and rough[pair] + np.log(prior[2]) > top - WITHIN:
            alone = max(singles[one].log_evidence for one in pair)
            weighed[name] = weigh(model, pair, psi, climb=rough[pair] > alone + GAIN)
            log_evidence[name] = weighed[name].log_evidence
            top = max(top, log_evidence[name] + np.log(prior[2]))
            screened.remove(name)
    return frozenset(screened)


def _count(name: str) -> int:
    """Return how many effects act in a hypothesis, by its name."""
    return 0 if name == NONE else name.count("+") + 1


def _rough_pairs(
    model: LinearModel, singles: dict[str, Weighed], effects: list[str], psi: Array
) -> dict[tuple[str, str], float]:
    """Return pairs' log evidence at given noise, laws and shapes as likely as of each alone."""
    with_columns = [name for name in effects if not singles[name].best.phases]
    columns = tuple(singles[name].best.columns[0] for name in with_columns)
    mean, sd = model.prior(columns)
    information = model.information(psi, Acting(columns))
    reduced = information.reduced(mean, sd, model.places(columns))
    inside = np.array(list(combinations(range(len(columns)), 2)), dtype=np.intp).reshape(-1, 2)
    values = combine(model, reduced, inside, np.array(columns, dtype=np.intp)[inside])
    known = dict(zip(combinations(with_columns, 2), values, strict=True))
    rough = {}
    for a, b in combinations(effects, 2):
        if (a, b) in known:
            rough[a, b] = float(known[a, b]) + model.log_prior(psi)
        else:
            rough[a, b] = _rough_pair(model, singles[a], singles[b], psi)
        rough[a, b] += sum(_other_choices(model, singles[name]) for name in (a, b))
    return rough


def _other_choices(model: LinearModel, one: Weighed) -> float:
    """Return what an effect's other laws and shapes add to the log evidence of its best."""
    (place,) = (*one.best.columns, *one.best.phases)
    return float(model.candidates[place].log_weight - one.log_weights.max())


def _rough_pair(model: LinearModel, one: Weighed, other: Weighed, psi: Array) -> float:
    """Return a pair's log evidence at given noise, laws and shapes those of each alone."""
    acting = Acting(one.best.columns + other.best.columns, one.best.phases + other.best.phases)
    mean, sd = model.prior(acting.columns)
    information = model.information(psi, acting)
    reduced = information.reduced(mean, sd, np.array([], dtype=np.intp))
    return reduced.log_evidence + model.log_prior(psi)


def _further(
    model: LinearModel,
    effects: list[str],
    weighed: dict[str, Weighed],
    log_evidence: dict[str, float],
) -> None:
    """Add effects to the best hypothesis as long as the evidence asks for it."""
    for number in range(3, MOST + 1):
        best = max(weighed.values(), key=lambda one: one.log_evidence)
        if len(best.names) != number - 1:
            return
        rough = {
            name: _rough_pair(model, best, weighed[name], best.psi)
            for name in effects
            if name not in best.names
        }
        if not rough:
            return
        name = max(rough, key=lambda one: rough[one])
        if rough[name] < best.log_evidence + WORTH:
            return
        found = weigh(model, (*best.names, name), best.psi)
        weighed[label(found.names)] = found
        log_evidence[label(found.names)] = found.log_evidence


def unknown_evidence(model: LinearModel, psi: Array, acting: Acting) -> Unknown:
    """Weigh a smooth force beyond the discrepancy, along all axes or any single one.

    Parameters
    ----------
    model : LinearModel
        The boards.
    psi : ndarray
        Logarithms of the noise, a start.
    acting : Acting
        What acts beside it.
    """
    if not model.smooths:
        return Unknown((), np.empty(0), -np.inf, psi)
    # It comes on top of the discrepancy that every hypothesis has.
    shares = np.hypot(model.practical_share, UNKNOWN_SCALE * halfnorm.ppf(UNKNOWN_NODES))
    # A constant of one board is looked for alone: what varies there would dilute it.
    kinds = [(smooth.axis, bool(smooth.axes)) for smooth in model.smooths]
    groups = [tuple(range(len(kinds)))]
    groups += [
        tuple(k for k, one in enumerate(kinds) if one == kind) for kind in dict.fromkeys(kinds)
    ]
    nodes = tuple(Wide(float(share), group) for group in groups for share in shares)
    # A force that nobody looked for went into the scatter: try with less of it as well.
    starts = (psi, model.quiet(psi))
    at = max(starts, key=lambda start: float(model.log_joints(start, acting, nodes).max()))
    values = model.log_joints(at, acting, nodes)
    for _ in range(2):
        at, _ = model.climb(at, acting, nodes[int(np.argmax(values))])
        values = model.log_joints(at, acting, nodes)
    return Unknown(
        nodes,
        values - logsumexp(values),
        float(logsumexp(values) - np.log(len(nodes))),
        at,
    )


def _volumes(
    model: LinearModel, weighed: Mapping[str, Weighed], log_evidence: dict[str, float]
) -> float:
    """Integrate over the noise of the leading hypotheses, and of the rest alike.

    Returns the spread of the volumes, the error of taking one for another.
    """
    reference = model.log_volume(weighed[NONE].psi, Acting())
    top = max(log_evidence.values())
    volumes = [reference]
    for name, value in log_evidence.items():
        near = name in weighed and name != NONE and value > top - NEAR
        volume = reference
        if near:
            volume = model.log_volume(weighed[name].psi, weighed[name].best)
            volumes.append(volume)
        log_evidence[name] = value + volume
    return float(np.ptp(volumes))

"""Hypotheses that were weighed, and their posterior probabilities."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.special import logsumexp

from bayesfric.analysis import HypothesisPriors
from bayesfric.arrays import Array
from bayesfric.diagnosis.classes import Classes
from bayesfric.diagnosis.unknown import Unknown
from bayesfric.diagnosis.weighing import Weighed
from bayesfric.probabilities import normalised, total

NONE, UNKNOWN = "none", "unknown"
LISTED = 1e-6  # probability below which a hypothesis is not listed
CONTRADICTED = 0.95  # of causes whose held-out shrink lies below the model's by its 90 % interval
MOSTLY = 0.5  # probability, from which on effects beside the largest are none
BESIDE = 0.1  # of unknown forces, that come beside smaller effects


@dataclass(frozen=True)
class Search:
    """Hypotheses weighed.

    Parameters
    ----------
    weighed : dict of str to Weighed
        Named ones and ``none``.
    rough : dict of str to float
        Log evidence of hypotheses that were screened only.
    unknown : Unknown or None
        An unknown force; None where there are no smooth forces.
    classes : Classes
        What is identical, absorbed or left out.
    priors : HypothesisPriors
        Of hypotheses by their number of effects.
    inverse : ndarray
        Of the curvature of the noise without effects.
    volume : float
        Log Laplace volume of the noise, where a hypothesis has none of its own.
    foreign : mapping of frozenset of str to float
        By effects that act together: the probability, given that they do, that they leave so
        much that an unknown force acts. That share of theirs counts as ``unknown``.
    minor : tuple of (frozenset of str, float), or None
        Effects that make most of the gap, and the probability that they leave a force that is like
        what all other effects take: that share of hypotheses with others is theirs alone.
    unheard : bool
        Whether an unknown force was asked for and nothing varied along which it could show: the
        data say of it what they say of none.
    """

    weighed: dict[str, Weighed]
    rough: dict[str, float]
    unknown: Unknown | None
    classes: Classes
    priors: HypothesisPriors
    inverse: Array
    volume: float
    foreign: Mapping[frozenset[str], float] = field(default_factory=dict)
    minor: tuple[frozenset[str], float] | None = None
    unheard: bool = False

    @property
    def none(self) -> Weighed:
        """The baseline alone."""
        return self.weighed[NONE]

    def log_prior(self, name: str, none: float | None = None) -> float:
        """Return the log prior probability of a hypothesis, with another one of none."""
        prior = self.priors
        rest = 1.0 if none is None else (1 - none) / (1 - prior.none)
        if name == NONE:
            return float(np.log(prior.none if none is None else none))
        if name == UNKNOWN:
            return float(np.log(rest * prior.unknown))
        names = name.split("+")
        mass = {1: prior.one, 2: prior.two}.get(len(names), prior.more)
        return float(np.log(rest * mass)) + self.classes.log_prior_among(names)

    def with_unknown(self, alone: Unknown, beside: Unknown, name: str) -> "Search":
        """Return these with an unknown force, alone or beside the effects of a hypothesis.

        Of unknown forces that come beside effects, those beside certain ones are as rare as
        these effects are among all: each of them could have been the leader.
        """
        acting = self.priors.one + self.priors.two + self.priors.more
        among = self.log_prior(name) - np.log(acting)
        parts = np.array([alone.log_evidence, beside.log_evidence])
        parts += np.log([1 - BESIDE, BESIDE]) + np.array([0.0, among])
        larger = alone if parts[0] > parts[1] else beside
        return replace(self, unknown=replace(larger, log_evidence=float(logsumexp(parts))))

    def worth(self, hypothesis: Weighed) -> float:
        """Return the log of evidence times prior."""
        return hypothesis.log_evidence + self.log_prior(hypothesis.label)

    def probabilities(self, none: float | None = None) -> dict[str, float]:
        """Return posterior probabilities, the largest first, summing to 1."""
        values = {name: value.log_evidence for name, value in self.weighed.items()}
        values |= {name: value for name, value in self.rough.items() if name not in values}
        if self.unknown is not None:
            values[UNKNOWN] = self.unknown.log_evidence
        elif self.unheard:
            values[UNKNOWN] = self.none.log_evidence
        names = list(values)
        logs = np.array([values[name] + self.log_prior(name, none) for name in names])
        chances = dict(zip(names, np.exp(logs - logsumexp(logs)), strict=True))
        listed = {n for n, chance in chances.items() if chance > LISTED} | {NONE}
        ranked = sorted(listed, key=lambda name: (-chances[name], name))
        by_name = normalised({name: float(chances[name]) for name in ranked})
        by_name.setdefault(UNKNOWN, 0.0)
        by_name = self._without_minor(by_name)
        return self._with_foreign(by_name) if self.foreign else by_name

    def overruled(self, effects: frozenset[str]) -> "Search":
        """Return these where held-out data contradict that effects make the gap."""
        before = self.foreign.get(effects, 0.0)
        share = 1 - (1 - before) * (1 - CONTRADICTED)
        return replace(self, foreign={**self.foreign, effects: share})

    def _without_minor(self, chances: dict[str, float]) -> dict[str, float]:
        """Return probabilities, those of effects beside the largest moved to the largest alone."""
        if self.minor is None:
            return chances
        largest, share = self.minor
        alone = "+".join(sorted(largest))
        moved = {alone: 0.0, **chances}
        for name, chance in chances.items():
            if largest < set(name.split("+")):
                moved[name] -= share * chance
                moved[alone] += share * chance
        ranked = sorted(normalised(moved).items(), key=lambda pair: (-pair[1], pair[0]))
        return dict(ranked)

    def _with_foreign(self, chances: dict[str, float]) -> dict[str, float]:
        shared = chances.copy()
        for name, chance in chances.items():
            acting = set(name.split("+"))
            shares = [share for effects, share in self.foreign.items() if effects <= acting]
            kept = math.prod(1 - share for share in shares)
            shared[name] -= (1 - kept) * chance
            shared[UNKNOWN] += (1 - kept) * chance
        ranked = sorted(normalised(shared).items(), key=lambda pair: (-pair[1], pair[0]))
        return dict(ranked)

    def unvisited(self) -> float:
        """Return the probability of hypotheses that were screened only."""
        chances = self.probabilities()
        return total(chances.get(name, 0.0) for name in self.rough if name not in self.weighed)

    def best(self) -> Weighed:
        """Return the most probable hypothesis of those with names, none among them."""
        weighed = list(self.weighed.values())
        if self.minor is not None and self.minor[1] >= MOSTLY:
            weighed = [
                hypothesis for hypothesis in weighed if not self.minor[0] < set(hypothesis.names)
            ]
        return max(weighed, key=self.worth)

"""Hypotheses with their evidences, and their posterior probabilities."""

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
from bayesfric.diagnosis_rules import RULES
from bayesfric.hypothesis import NONE, UNKNOWN, Hypothesis
from bayesfric.probabilities import normalised, total


@dataclass(frozen=True)
class Search:
    """Hypotheses with their evidences.

    Parameters
    ----------
    weighed : dict of Hypothesis to Weighed
        Hypotheses with effects, and `none`.
    rough : dict of Hypothesis to float
        Log evidence of hypotheses that were screened only.
    unknown : Unknown or None
        An unknown force; None without smooth forces.
    classes : Classes
        Effects that are identical, absorbed or left out.
    priors : HypothesisPriors
        Prior probabilities of hypotheses, by their number of effects.
    inverse : ndarray
        Inverse curvature of the noise without effects.
    volume : float
        Log Laplace volume of the noise, for hypotheses without their own.
    foreign : mapping of Hypothesis to float
        By effects that act together: the probability, given that they act, that they leave so much
        of the gap that an unknown force acts. This part of their probability moves to ``unknown``.
    minor : tuple of (Hypothesis, float), or None
        Effects that make most of the gap, and the probability that they leave a force as large as
        what the other effects explain. This part of the probability of hypotheses with further
        effects moves to the hypothesis with these effects alone.
    doubted : frozenset of str
        Effects without which held-out data are predicted as well. Half of the probability of a
        hypothesis with such an effect moves to the same hypothesis without it.
    nothing_varied : bool
        Whether no axis varied along which an unknown force could appear. Its evidence is then that
        of `none`.
    """

    weighed: dict[Hypothesis, Weighed]
    rough: dict[Hypothesis, float]
    unknown: Unknown | None
    classes: Classes
    priors: HypothesisPriors
    inverse: Array
    volume: float
    foreign: Mapping[Hypothesis, float] = field(default_factory=dict)
    minor: tuple[Hypothesis, float] | None = None
    doubted: frozenset[str] = frozenset()
    nothing_varied: bool = False

    @property
    def none(self) -> Weighed:
        """The hypothesis without effects."""
        return self.weighed[NONE]

    def log_prior(self, hypothesis: Hypothesis, none: float | None = None) -> float:
        """Return the log prior probability of a hypothesis; `none` replaces the prior of none."""
        prior = self.priors
        rest = 1.0 if none is None else (1 - none) / (1 - prior.none)
        if hypothesis == NONE:
            return float(np.log(prior.none if none is None else none))
        if hypothesis == UNKNOWN:
            return float(np.log(rest * prior.unknown))
        mass = {1: prior.one, 2: prior.two}.get(len(hypothesis), prior.more)
        return float(np.log(rest * mass)) + self.classes.log_prior_among(hypothesis)

    def with_unknown(self, alone: Unknown, beside: Unknown, effects: Hypothesis) -> "Search":
        """Return the search with an unknown force, alone or together with the effects given.

        If the force acts together with effects, its prior is multiplied by the prior of these
        effects among all sets of effects, because any other set could have been the best.
        """
        acting = self.priors.one + self.priors.two + self.priors.more
        among = self.log_prior(effects) - np.log(acting)
        parts = np.array([alone.log_evidence, beside.log_evidence])
        parts += np.log([1 - RULES.beside_effects, RULES.beside_effects]) + np.array([0.0, among])
        larger = alone if parts[0] > parts[1] else beside
        return replace(self, unknown=replace(larger, log_evidence=float(logsumexp(parts))))

    def worth(self, weighed: Weighed) -> float:
        """Return the log of evidence times prior."""
        return weighed.log_evidence + self.log_prior(weighed.hypothesis)

    def probabilities(self, none: float | None = None) -> dict[Hypothesis, float]:
        """Return posterior probabilities, the largest first, summing to 1."""
        values = {acting: weighed.log_evidence for acting, weighed in self.weighed.items()}
        values |= {acting: rough for acting, rough in self.rough.items() if acting not in values}
        if self.unknown is not None:
            values[UNKNOWN] = self.unknown.log_evidence
        elif self.nothing_varied:
            values[UNKNOWN] = self.none.log_evidence
        logs = np.array([value + self.log_prior(acting, none) for acting, value in values.items()])
        chances = dict(zip(values, np.exp(logs - logsumexp(logs)).tolist(), strict=True))
        listed = {acting: p for acting, p in chances.items() if p > RULES.listed or acting == NONE}
        ranked = _ranked(listed)
        ranked.setdefault(UNKNOWN, 0.0)
        ranked = self._with_doubts(self._without_minor(ranked))
        return self._with_foreign(ranked) if self.foreign else ranked

    def overruled(self, effects: Hypothesis) -> "Search":
        """Return the search after held-out data contradicted these effects."""
        before = self.foreign.get(effects, 0.0)
        share = 1 - (1 - before) * (1 - RULES.contradicted)
        return replace(self, foreign={**self.foreign, effects: share})

    def _without_minor(self, chances: dict[Hypothesis, float]) -> dict[Hypothesis, float]:
        """Move probability from hypotheses with minor effects to the largest effects alone."""
        if self.minor is None:
            return chances
        largest, share = self.minor
        moved = {largest: 0.0, **chances}
        for hypothesis, chance in chances.items():
            if largest < hypothesis:
                moved[hypothesis] -= share * chance
                moved[largest] += share * chance
        return _ranked(moved)

    def _with_doubts(self, chances: dict[Hypothesis, float]) -> dict[Hypothesis, float]:
        """Move half of the probability of each doubted effect to the hypothesis without it."""
        for name in sorted(self.doubted):
            moved = dict(chances)
            for hypothesis, chance in chances.items():
                without = Hypothesis(hypothesis - {name})
                if name in hypothesis and without in self.weighed:
                    moved[hypothesis] -= RULES.likely * chance
                    moved[without] = moved.get(without, 0.0) + RULES.likely * chance
            chances = _ranked(moved)
        return chances

    def _with_foreign(self, chances: dict[Hypothesis, float]) -> dict[Hypothesis, float]:
        shared = chances.copy()
        for acting, chance in chances.items():
            shares = [share for effects, share in self.foreign.items() if effects <= acting]
            kept = math.prod(1 - share for share in shares)
            shared[acting] -= (1 - kept) * chance
            shared[UNKNOWN] += (1 - kept) * chance
        return _ranked(shared)

    def unvisited(self) -> float:
        """Return the total probability of hypotheses that were only screened."""
        chances = self.probabilities()
        screened = self.rough.keys() - self.weighed.keys()
        return total(chances.get(hypothesis, 0.0) for hypothesis in screened)

    def best(self) -> Weighed:
        """Return the most probable hypothesis, except for an unknown force."""
        weighed = list(self.weighed.values())
        if self.minor is not None and self.minor[1] >= RULES.likely:
            weighed = [rival for rival in weighed if not self.minor[0] < rival.hypothesis]
        weighed = [rival for rival in weighed if not self.doubted & rival.hypothesis]
        return max(weighed, key=self.worth)


def _ranked(chances: Mapping[Hypothesis, float]) -> dict[Hypothesis, float]:
    """Return normalised probabilities, the largest first, equal ones by name."""
    added = normalised(chances)
    return dict(sorted(added.items(), key=lambda pair: (-pair[1], str(pair[0]))))

"""Rates and figures over cases, each with a 95 % interval."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
import scipy
from numpy.typing import NDArray

from bayesfric.arrays import Array
from bayesfric.schemas.scorecard import Detected, Estimate, Rate, ReliabilityBin

LEVEL = 0.95
TAILS = ((1 - LEVEL) / 2, (1 + LEVEL) / 2)
DRAWS = 2000
RATE_DRAWS = 400
SEED = 1987  # seed of the bootstrap and the consistency bands
EDGES = (0.0, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99, 1.0)
DETECTED = 0.8  # share of the cases in which a detected effect is named


def rate_of(hits: Iterable[bool]) -> Rate:
    """Return a rate with the interval of Clopper and Pearson (Biometrika 26, 1934)."""
    outcomes = list(hits)
    if not outcomes:
        return Rate(rate=None, low=0.0, high=1.0, hits=0, cases=0)
    interval = scipy.stats.binomtest(sum(outcomes), len(outcomes)).proportion_ci(
        LEVEL, method="exact"
    )
    return Rate(
        rate=sum(outcomes) / len(outcomes),
        low=float(interval.low),
        high=float(interval.high),
        hits=sum(outcomes),
        cases=len(outcomes),
    )


def estimate_of(values: Sequence[float]) -> Estimate:
    """Return a mean with its percentile bootstrap interval (Efron 1979)."""
    if not values:
        return Estimate(value=None, low=None, high=None, cases=0)
    scores = np.array(values)
    rng = np.random.default_rng(SEED)
    means = scores[rng.integers(0, scores.size, (DRAWS, scores.size))].mean(axis=1)
    low, high = (float(q) for q in np.quantile(means, TAILS))
    return Estimate(value=float(scores.mean()), low=low, high=high, cases=scores.size)


def reliability_of(
    probability: Sequence[float], correct: Sequence[bool], edges: Sequence[float] = EDGES
) -> list[ReliabilityBin]:
    """Return how often verdicts were correct, in bins of their probability.

    The band is that of Bröcker and Smith (Weather and Forecasting 22, 2007), under which each
    case of the bin is correct with the probability that it reports.

    Parameters
    ----------
    probability : sequence of float
        Probability that each verdict reports.
    correct : sequence of bool
        Whether each verdict is correct.
    edges : sequence of float
        Edges of the bins, from 0 to 1.
    """
    chance, right = np.array(probability), np.array(correct, dtype=bool)
    place = np.clip(np.searchsorted(edges, chance, side="right") - 1, 0, len(edges) - 2)
    rng = np.random.default_rng(SEED)
    bins = []
    for number in range(len(edges) - 1):
        own = place == number
        if not own.any():
            continue
        drawn = (rng.uniform(size=(DRAWS, int(own.sum()))) < chance[own]).mean(axis=1)
        low, high = (float(q) for q in np.quantile(drawn, TAILS, method="nearest"))
        rate = rate_of(bool(hit) for hit in right[own])
        assert rate.rate is not None
        bins.append(
            ReliabilityBin(
                lower=edges[number],
                upper=edges[number + 1],
                cases=int(own.sum()),
                probability=float(chance[own].mean()),
                correct=rate,
                band=(low, high),
                inside=low - 1e-12 <= rate.rate <= high + 1e-12,
            )
        )
    return bins


def smallest_detected(named: Mapping[float, Sequence[bool]]) -> Detected:
    """Return the smallest strength that is named in 80 % of cases.

    Each strength has few cases, so rates are assumed to grow with strength (isotonic regression).
    The interval is over their Jeffreys posteriors (Brown, Cai and DasGupta 2001).

    Parameters
    ----------
    named : mapping of float to sequence of bool
        By strength: whether the effect was named, for each case.
    """
    strengths = np.array(sorted(named))
    hits = np.array([sum(named[s]) for s in strengths])
    cases = np.array([len(named[s]) for s in strengths])
    rng = np.random.default_rng(SEED)
    drawn = rng.beta(hits + 0.5, cases - hits + 0.5, (RATE_DRAWS, strengths.size))
    least_of_each_draw = [_least(strengths, rates, cases) for rates in drawn]
    least = _least(strengths, hits / cases, cases)
    low, high = (float(q) for q in np.quantile(least_of_each_draw, TAILS, method="nearest"))
    why = "at no strength that was tried"
    return Detected(
        value=_finite(least),
        value_why=None if np.isfinite(least) else why,
        low=_finite(low),
        low_why=None if np.isfinite(low) else why,
        high=_finite(high),
        high_why=None if np.isfinite(high) else why,
        cases=int(cases.sum()),
        tried={f"{s:g}": rate_of(named[s]) for s in sorted(named)},
    )


def _least(strengths: Array, rates: Array, cases: NDArray[np.int_]) -> float:
    """Return the smallest strength with a high enough rate; inf if there is none."""
    grown = np.asarray(scipy.optimize.isotonic_regression(rates, weights=cases).x)
    high = np.flatnonzero(grown >= DETECTED - 1e-12)
    return float(strengths[high[0]]) if high.size else float("inf")


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None

"""Rates and figures over cases, each with a 95 % interval."""

from collections.abc import Callable, Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.stats import binomtest

from bayesfric.schemas import Detected, Estimate, Rate, ReliabilityBin

__all__ = ["estimate_of", "rate_of", "reliability_of", "smallest_detected"]

Array = NDArray[np.float64]
LEVEL = 0.95
TAILS = ((1 - LEVEL) / 2, (1 + LEVEL) / 2)
DRAWS = 2000
SEED = 1987  # of the bootstrap and the consistency bands
EDGES = (0.0, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99, 1.0)
DETECTED = 0.8  # of the cases


def rate_of(hits: Iterable[bool]) -> Rate:
    """Return a rate with the interval of Clopper and Pearson (Biometrika 26, 1934)."""
    each = list(hits)
    if not each:
        return Rate(rate=None, rate_why="no case counts", low=0.0, high=1.0, hits=0, cases=0)
    interval = binomtest(sum(each), len(each)).proportion_ci(LEVEL, method="exact")
    return Rate(
        rate=sum(each) / len(each),
        low=float(interval.low),
        high=float(interval.high),
        hits=sum(each),
        cases=len(each),
    )


def estimate_of(values: Sequence[float]) -> Estimate:
    """Return a mean with the interval of its bootstrap (Efron 1979), percentiles."""
    if not values:
        why = "no case counts"
        return Estimate(
            value=None, value_why=why, low=None, low_why=why, high=None, high_why=why, cases=0
        )
    each = np.array(values)
    rng = np.random.default_rng(SEED)
    means = each[rng.integers(0, each.size, (DRAWS, each.size))].mean(axis=1)
    low, high = (float(q) for q in np.quantile(means, TAILS))
    return Estimate(value=float(each.mean()), low=low, high=high, cases=each.size)


def reliability_of(probability: Sequence[float], correct: Sequence[bool]) -> list[ReliabilityBin]:
    """Return how often verdicts of about one probability were correct.

    The band is that of Bröcker and Smith (Weather and Forecasting 22, 2007): each case of
    the bin comes true with the probability that it reported.

    Parameters
    ----------
    probability : sequence of float
        Of each verdict.
    correct : sequence of bool
        Whether it was.
    """
    chance, right = np.array(probability), np.array(correct, dtype=bool)
    place = np.clip(np.searchsorted(EDGES, chance, side="right") - 1, 0, len(EDGES) - 2)
    rng = np.random.default_rng(SEED)
    found = []
    for number in range(len(EDGES) - 1):
        own = place == number
        if not own.any():
            continue
        drawn = (rng.uniform(size=(DRAWS, int(own.sum()))) < chance[own]).mean(axis=1)
        low, high = (float(q) for q in np.quantile(drawn, TAILS, method="nearest"))
        rate = rate_of(bool(one) for one in right[own])
        assert rate.rate is not None
        found.append(
            ReliabilityBin(
                lower=EDGES[number],
                upper=EDGES[number + 1],
                cases=int(own.sum()),
                probability=float(chance[own].mean()),
                correct=rate,
                band=(low, high),
                inside=low - 1e-12 <= rate.rate <= high + 1e-12,
            )
        )
    return found


def smallest_detected(named: Mapping[float, Sequence[bool]]) -> Detected:
    """Return the smallest strength that is named in 80 % of cases, as all above it are.

    Parameters
    ----------
    named : mapping of float to sequence of bool
        Strength to whether the effect was named, case by case.
    """
    strengths = sorted(named)
    rng = np.random.default_rng(SEED)
    rates = {s: float(np.mean(named[s])) for s in strengths}
    drawn = {s: rng.binomial(len(named[s]), rates[s], DRAWS) / len(named[s]) for s in strengths}
    least = _least(strengths, lambda s: np.array([rates[s]]))
    low, high = np.quantile(_least(strengths, lambda s: drawn[s]), TAILS, method="nearest")
    why = "at no strength that was tried"
    return Detected(
        value=_finite(least[0]),
        value_why=None if np.isfinite(least[0]) else why,
        low=_finite(low),
        low_why=None if np.isfinite(low) else why,
        high=_finite(high),
        high_why=None if np.isfinite(high) else why,
        cases=sum(len(each) for each in named.values()),
        tried={f"{s:g}": rate_of(named[s]) for s in strengths},
    )


def _least(strengths: Sequence[float], rate: Callable[[float], Array]) -> Array:
    """Return the smallest strength down to which rates stay high, inf where there is none."""
    found = np.full_like(rate(strengths[0]), np.inf, dtype=np.float64)
    holds = np.ones(found.shape, dtype=bool)
    for strength in reversed(strengths):
        holds &= rate(strength) >= DETECTED
        found = np.where(holds, strength, found)
    return found


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None

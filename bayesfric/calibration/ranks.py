"""Ranks of true values among posterior draws, and their deviation from a uniform distribution.

If prior, simulator and posterior agree, the rank of the true value among L posterior draws has
L + 1 equally probable values.

References
----------
S. Talts et al., "Validating Bayesian inference algorithms with simulation-based calibration"
(2018). T. Säilynoja, P.-C. Bürkner, A. Vehtari, "Graphical test for discrete uniformity and its
applications in goodness-of-fit evaluation and multiple sample comparison", Statistics and
Computing 32 (2022): the simultaneous band.
"""

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from bayesfric.arrays import Array

Ints = NDArray[np.int_]
SIMULATED = 20_000  # sets of uniform ranks


def rank_of(truth: float, draws: Array) -> int:
    """Return how many of L draws lie below the truth.

    Parameters
    ----------
    truth : float
        What the recording was made from.
    draws : ndarray, shape (L,)
        Of the posterior, as good as independent.
    """
    return int((draws < truth).sum())


@dataclass(frozen=True)
class Band:
    """How far the ranks of N recordings may be from uniform.

    Parameters
    ----------
    count : int
        N.
    places : int
        L + 1, of a rank.
    probability : ndarray, shape (L,)
        Expected share of ranks below 1, 2, … L.
    low, high : ndarray, shape (L,)
        Of the difference between that share and the expected one: uniform ranks stay between
        them everywhere with the level's probability.
    tails : ndarray, shape (N + 1, L)
        Two-sided tail probability of so many ranks below each place.
    extremes : ndarray, shape (S,)
        The least two-sided tail probability of each of S simulated sets.
    """

    count: int
    places: int
    probability: Array
    low: Array
    high: Array
    tails: Array
    extremes: Array

    def difference(self, ranks: Ints) -> Array:
        """Return the share of ranks below each place less the expected one, shape (L,)."""
        return self._below(ranks) / self.count - self.probability

    def p_value(self, ranks: Ints) -> float:
        """Return how often uniform ranks are as far out somewhere as these.

        Parameters
        ----------
        ranks : ndarray of int, shape (N,)
            From 0 to L.
        """
        own = _extremes(self._below(ranks)[None], self.tails)[0]
        return float((1 + (self.extremes <= own * (1 + 1e-12)).sum()) / (1 + self.extremes.size))

    def _below(self, ranks: Ints) -> Ints:
        return np.bincount(ranks, minlength=self.places).cumsum()[:-1]


def band_of(count: int, places: int, level: float) -> Band:
    """Return the simultaneous band of N uniform ranks.

    Parameters
    ----------
    count : int
        Recordings N.
    places : int
        Values of a rank, L + 1.
    level : float
        Probability with which uniform ranks stay inside everywhere.
    """
    probability = np.arange(1, places) / places
    rng = np.random.default_rng(np.random.SeedSequence([count, places]))
    drawn = rng.multinomial(count, np.full(places, 1 / places), size=SIMULATED)
    tails = _tails(count, probability)
    extremes = _extremes(drawn.cumsum(axis=1)[:, :-1], tails)
    tail = float(np.quantile(extremes, 1 - level)) / 2
    low, high = (scipy.stats.binom.ppf(end, count, probability) / count for end in (tail, 1 - tail))
    return Band(count, places, probability, low - probability, high - probability, tails, extremes)


def _tails(count: int, probability: Array) -> Array:
    """Return the two-sided tail probability of so many below each place, shape (N + 1, L)."""
    number = np.arange(count + 1)[:, None]
    below = scipy.stats.binom.cdf(number, count, probability)
    above = scipy.stats.binom.sf(number - 1, count, probability)
    return np.asarray(np.minimum(1.0, 2 * np.minimum(below, above)))


def _extremes(below: Ints, tails: Array) -> Array:
    return np.asarray(tails[below, np.arange(tails.shape[1])].min(axis=1))

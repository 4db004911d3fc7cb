"""Normal coefficients in groups, each group with its own unknown standard deviation.

The coefficients are those of a linear Gaussian model. A common standard deviation would be that of
the groups that the data inform best, and a larger group would be taken for noise. The standard
deviations (sizes) are drawn with the coefficients integrated out, one group after another (Gibbs),
and then the coefficients are drawn given the sizes.

References
----------
A. Doucet, "A note on efficient conditional simulation of Gaussian distributions" (2010).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bayesfric.arrays import Array, Whole

BURN_IN = 10  # sweeps over all groups before the first draw
DRAWS_A_SWEEP = 10  # draws of coefficients for the same sizes
LEAST_INFORMATION = 1e-3  # relative to the prior; below it data do not inform


@dataclass(frozen=True)
class Group:
    """Coefficients with a common standard deviation.

    Parameters
    ----------
    places : ndarray of int
        Indices of the coefficients.
    sizes : ndarray, shape (K,)
        Possible standard deviations, ascending; 0 means that the coefficients are 0.
    log_weights : ndarray, shape (K,)
        Log prior probability of each size.
    """

    places: Whole
    sizes: Array
    log_weights: Array


def drawn_in_groups(
    precision: Array,
    slope: Array,
    mixing: Array,
    groups: Sequence[Group],
    count: int,
    rng: np.random.Generator,
) -> Array:
    """Draw the coefficients and the sizes of their groups given the data.

    Parameters
    ----------
    precision : ndarray, shape (m, m)
        Information matrix of m combinations g of coefficients:
        ``log p(data | g) = slopeᵀg − gᵀ precision g / 2`` up to a constant.
    slope : ndarray, shape (m,)
        Slope of that form.
    mixing : ndarray, shape (m, n)
        The combinations of the n coefficients, which are normal with mean zero.
    groups : sequence of Group
        The groups; each coefficient is in exactly one of them.
    count : int
        Number of draws, S.
    rng : Generator
        Source of randomness.

    Returns
    -------
    ndarray, shape (S, n)
    """
    values, vectors = np.linalg.eigh(0.5 * (precision + precision.T))
    informed = values > LEAST_INFORMATION
    root = np.sqrt(values[informed])
    # The data are equivalent to q readings with unit error.
    design = root[:, None] * (vectors[:, informed].T @ mixing)
    readings = vectors[:, informed].T @ slope / root
    sizes = _Sizes(design, readings, groups)
    for _ in range(BURN_IN):
        sizes.sweep(rng)
    draws = [np.empty((0, sizes.sd.size))]
    for start in range(0, count, DRAWS_A_SWEEP):
        sizes.sweep(rng)
        shape = (min(DRAWS_A_SWEEP, count - start), sizes.sd.size)
        prior = sizes.sd * rng.standard_normal(shape)
        off = readings - prior @ design.T - rng.standard_normal((shape[0], readings.size))
        draws.append(prior + sizes.sd**2 * (off @ sizes.whitening() @ design))
    return np.concatenate(draws)


class _Sizes:
    """The present sizes of a Gibbs chain, given q readings with unit error."""

    def __init__(self, design: Array, readings: Array, groups: Sequence[Group]) -> None:
        self._design = design
        self._readings = readings
        self._groups = groups
        self._thin = [_thin(design[:, group.places]) for group in groups]
        self._chosen = [0] * len(groups)
        self._whitening: Array | None = None  # of the present sizes
        self.sd = np.empty(design.shape[1])
        for group in groups:
            self.sd[group.places] = group.sizes[0]

    def whitening(self) -> Array:
        """Return the inverse covariance of the readings, (q, q)."""
        if self._whitening is None:
            wide = self._design * self.sd
            whole = np.eye(self._readings.size) + wide @ wide.T
            self._whitening = np.asarray(np.linalg.inv(whole), dtype=np.float64)
        return self._whitening

    def sweep(self, rng: np.random.Generator) -> None:
        """Draw the size of each group, given those of the others."""
        inverse = self.whitening().copy()
        for place in rng.permutation(len(self._groups)):
            group, columns = self._groups[place], self._thin[place]
            moved = inverse @ columns
            information, axes = np.linalg.eigh(columns.T @ moved)
            pull = axes.T @ (moved.T @ self._readings)
            step = group.sizes**2 - group.sizes[self._chosen[place]] ** 2
            spread = 1 + step[:, None] * information
            gain = (step[:, None] * pull**2 / spread - np.log(spread)).sum(axis=1)
            number = _drawn(group.log_weights + 0.5 * gain, rng)
            if number != self._chosen[place]:
                self._chosen[place], self._whitening = number, None
                self.sd[group.places] = group.sizes[number]
                turned = moved @ axes
                inverse -= (turned * (step[number] / spread[number])) @ turned.T


def _drawn(log_weights: Array, rng: np.random.Generator) -> int:
    """Draw an index with these log probabilities, up to a constant.

    ``softmax`` and ``Generator.choice`` do the same, and take most of the time of a sweep.
    """
    levels = np.exp(log_weights - log_weights.max()).cumsum()
    return int(np.searchsorted(levels, rng.random() * levels[-1], side="right"))


def _thin(columns: Array) -> Array:
    """Return fewer columns with the same outer product."""
    left, singular, _ = np.linalg.svd(columns, full_matrices=False)
    return np.asarray((left * singular)[:, singular**2 > LEAST_INFORMATION])

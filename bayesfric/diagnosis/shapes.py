"""The evidence of effects that act together: amplitudes, shapes and laws integrated out.

Given the noise, amplitudes are normal (positive amplitudes are truncated at zero, which needs an
orthant probability). The column at any shape is a combination of those at the nodes.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, product
from typing import TypeAlias

import numpy as np
import scipy
from scipy.special import log_ndtr, ndtr, owens_t

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.diagnosis.acting import Law
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis_rules import RULES
from bayesfric.effects.candidates import is_positive, prior_moments
from bayesfric.inference.information import Reduced
from bayesfric.inference.priors import LOG_2

WIDEST = 2.4  # normal quantile of a shape
GRID = np.linspace(-WIDEST, WIDEST, 49)
FINER, ZOOMS = np.linspace(-1.0, 1.0, 13), 3
MAXIMA = 3  # over a shape, around which the grid is refined
SWEEPS = 2  # over the shapes of effects that act together, one shape at a time
NEAREST = 1e-100  # least absolute mean in standard deviations
Places: TypeAlias = tuple[int, ...]
"""Candidates of a law."""


@dataclass(frozen=True)
class Choice:
    """Laws and shapes of effects that act together.

    Parameters
    ----------
    laws : tuple of Law
        One law for each effect.
    shapes : tuple of float
        The best shapes, as normal quantiles.
    log_evidence : float
        Log evidence with shapes integrated out, including the prior weights of the laws.
    """

    laws: tuple[Law, ...]
    shapes: tuple[float, ...]
    log_evidence: float


class Quadratic:
    """A quadratic form in the amplitudes of candidates, and their priors.

    Parameters
    ----------
    model : LinearModel
        Contains the priors.
    reduced : Reduced
        The quadratic form.
    places : sequence of int
        Candidates of its rows.
    """

    def __init__(self, model: LinearModel, reduced: Reduced, places: Sequence[int]) -> None:
        self._model, self.reduced = model, reduced
        self._row = {place: row for row, place in enumerate(places)}
        self._rows: dict[Places, Whole] = {}
        self._blocks: dict[tuple[Places, Places], Array] = {}
        self._coarse: dict[tuple[Places, tuple[float, ...]], Array] = {}
        self._mixtures: dict[tuple[Places, tuple[float, ...], float], Array] = {}

    def _rows_of(self, law: Law) -> Whole:
        if law.places not in self._rows:
            self._rows[law.places] = np.array([self._row[place] for place in law.places])
        return self._rows[law.places]

    def _block(self, first: Law, second: Law) -> Array:
        """Return the block of the precision for the candidates of two laws."""
        key = first.places, second.places
        if key not in self._blocks:
            rows = np.ix_(self._rows_of(first), self._rows_of(second))
            self._blocks[key] = self.reduced.precision[rows]
        return self._blocks[key]

    def _mixture(self, law: Law, shape: Array) -> Array:
        """Return the weights of a law's candidates at shapes; those of single shapes are cached."""
        if len(shape) > 1:
            return law.weights(shape)
        key = law.places, law.nodes, float(shape[0])
        if key not in self._mixtures:
            self._mixtures[key] = law.weights(shape)
        return self._mixtures[key]

    def _mixed(self, laws: Sequence[Law], shapes: Sequence[Array]) -> tuple[Array, Array]:
        """Return precision (M, k, k) and slope (M, k) at M choices of shapes."""
        weights = [self._mixture(law, shape) for law, shape in zip(laws, shapes, strict=True)]
        count = max(len(weight) for weight in weights)
        k = len(laws)
        precision, slope = np.empty((count, k, k)), np.empty((count, k))
        for i in range(k):
            slope[:, i] = weights[i] @ self.reduced.slope[self._rows_of(laws[i])]
            for j in range(i + 1):
                across = weights[i] @ self._block(laws[i], laws[j])
                value = (across * weights[j]).sum(axis=1)
                precision[:, i, j] = precision[:, j, i] = value
        return precision, slope

    def values(self, laws: Sequence[Law], shapes: Sequence[Array], *, exact: bool = False) -> Array:
        """Return the log evidence that amplitudes add, at M choices of shapes, (M,).

        Parameters
        ----------
        laws : sequence of Law
            One law for each effect.
        shapes : sequence of ndarray, shape (M,) or (1,)
            Shapes of each law.
        exact : bool
            Whether orthant probabilities are those of the joint normal, instead of the product
            of its marginals.
        """
        return self._values(self._priors(laws), *self._mixed(laws, shapes), exact=exact)

    def each_value(
        self, combinations: Sequence[Sequence[Law]], shapes: Sequence[Sequence[float]]
    ) -> Array:
        """Return the same of M combinations of as many laws, each at shapes of its own, (M,)."""
        pairs = [list(zip(*both, strict=True)) for both in zip(combinations, shapes, strict=True)]
        alone = list(dict.fromkeys(chain.from_iterable(pairs)))
        place = {pair: row for row, pair in enumerate(alone)}
        mixing = np.zeros((len(alone), len(self._row)))
        for (law, shape), row in place.items():
            mixing[row, self._rows_of(law)] = self._mixture(law, np.array([shape]))[0]
        every = np.array([[place[pair] for pair in own] for own in pairs])
        precision = mixing @ self.reduced.precision @ mixing.T
        slope = mixing @ self.reduced.slope
        at, positive = self._priors([law for law, _ in alone])
        priors = at[every], positive[every]
        return self._values(priors, precision[every[:, :, None], every[:, None]], slope[every])

    def _priors(self, laws: Sequence[Law]) -> tuple[Array, Flags]:
        """Return prior means over standard deviations, and which amplitudes are positive, (k,)."""
        priors = [self._model.amplitude_prior(law) for law in laws]
        moments = np.array([prior_moments(prior) for prior in priors]).reshape(-1, 2)
        return moments[:, 0] / moments[:, 1], np.array([*map(is_positive, priors)], dtype=np.bool_)

    def _values(
        self, priors: tuple[Array, Flags], precision: Array, slope: Array, *, exact: bool = False
    ) -> Array:
        """Return the same of precisions, (M, k, k), and slopes, (M, k).

        Priors of all, (k,), or of each, (M, k), are as :meth:`_priors` returns them.
        """
        at, positive = priors
        covariance = _inverse(precision + np.eye(slope.shape[1]))
        slope = slope + at
        mean = (covariance @ slope[:, :, None])[:, :, 0]
        value = 0.5 * (slope * mean).sum(axis=1) + 0.5 * np.linalg.slogdet(covariance)[1]
        value += positive.sum(axis=-1) * LOG_2 - 0.5 * (at**2).sum(axis=-1)
        if exact:
            part = np.ix_(positive, positive)
            return np.asarray(
                [
                    v + log_orthant(m[positive], c[part])
                    for v, m, c in zip(value, mean, covariance, strict=True)
                ]
            )
        sd = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
        return np.asarray(value + np.where(positive, log_ndtr(mean / sd), 0.0).sum(axis=1))

    def _values_along(
        self, laws: Sequence[Law], shapes: Sequence[float], which: int
    ) -> Callable[[Array], Array]:
        """Return what makes the same of weights of one law's candidates, all other shapes held.

        The others are integrated out once, so that no shape needs a matrix of its own.
        """
        held = [np.array([shape]) for shape in shapes]
        precision, slope = (values[0] for values in self._mixed(laws, held))
        at, positive = self._priors(laws)
        law, others = laws[which], [place for place in range(len(laws)) if place != which]
        own, of_law = self._block(law, law), self.reduced.slope[self._rows_of(law)]
        across = np.zeros((len(law.places), len(others)))
        for column, j in enumerate(others):
            across[:, column] = self._block(law, laws[j]) @ self._mixture(laws[j], held[j])[0]
        inner = precision[np.ix_(others, others)] + np.eye(len(others))
        covariance = _inverse(inner[None])[0]
        slope_held = slope[others] + at[others]
        mean, variance = covariance @ slope_held, np.diag(covariance)
        constant = 0.5 * (slope_held @ mean + np.linalg.slogdet(covariance)[1] - at @ at)
        constant += positive.sum() * LOG_2

        def values(weights: Array) -> Array:
            mixed = weights @ across
            pulled = mixed @ covariance
            stiff = 1 + ((weights @ own) * weights).sum(axis=1) - (pulled * mixed).sum(axis=1)
            stiff = np.maximum(stiff, 1.0)  # rounding of what is very large hides the prior
            moved = (weights @ of_law + at[which] - mixed @ mean) / stiff
            value = constant + 0.5 * (moved**2 * stiff - np.log(stiff))
            if positive[which]:
                value += log_ndtr(moved * np.sqrt(stiff))
            sd = np.sqrt(variance + pulled**2 / stiff[:, None])
            beside = log_ndtr((mean - pulled * moved[:, None]) / sd)
            return np.asarray(value + beside[:, positive[others]].sum(axis=1))

        return values

    def along(
        self, laws: Sequence[Law], shapes: Sequence[float], which: int
    ) -> tuple[float, float, float]:
        """Return the best shape of one effect, its integral over the prior, and its value.

        The shapes of the others are fixed.
        """
        values = self._values_along(laws, shapes, which)
        grid = GRID
        key = laws[which].places, laws[which].nodes
        if key not in self._coarse:
            self._coarse[key] = laws[which].weights(grid)
        values_along = values(self._coarse[key])
        width = grid[1] - grid[0]
        # A narrow maximum between two places of the grid may be higher than a wide one at a place.
        for _ in range(ZOOMS):
            near = grid[_highest(values_along)]
            more = np.unique(np.clip(near[:, None] + width * FINER, -WIDEST, WIDEST))
            grid, first = np.unique(np.append(grid, more), return_index=True)
            values_along = np.append(values_along, values(laws[which].weights(more)))[first]
            width *= FINER[1] - FINER[0]
        prior = np.exp(-0.5 * grid**2) * np.gradient(grid)
        density = values_along - 0.5 * grid**2
        place, top = int(np.argmax(density)), float(values_along.max())
        mean = (prior * np.exp(values_along - top)).sum() / prior.sum()
        return float(grid[place]), top + float(np.log(mean)), float(values_along[place])

    def choice(self, laws: Sequence[Law], start: Sequence[float] | None = None) -> Choice:
        """Return the best shapes of given laws; shapes are integrated out one at a time."""
        shapes = list(start) if start is not None else [0.0] * len(laws)
        free = [place for place, law in enumerate(laws) if law.has_shape]
        gain = 0.0
        followed: dict[tuple[float, ...], tuple[float, float, float]] = {}
        for _ in range(SWEEPS if len(free) > 1 else 1):
            gain = 0.0
            for place in free:
                # The shapes of the others determine the result.
                others = place, *shapes[:place], *shapes[place + 1 :]
                if others not in followed:
                    followed[others] = self.along(laws, shapes, place)
                shapes[place], integral, value_there = followed[others]
                gain += integral - value_there
        at = [np.array([shape]) for shape in shapes]
        value = float(self.values(laws, at, exact=True)[0]) if laws else 0.0
        weight = sum(law.log_weight for law in laws)
        return Choice(tuple(laws), tuple(shapes), value + gain + weight)


def _highest(values: Array) -> Whole:
    """Return the places of the highest local maxima, at most :data:`MAXIMA`."""
    rises = np.append(True, values[1:] > values[:-1])
    falls = np.append(values[1:] <= values[:-1], True)
    maxima = np.flatnonzero(rises & falls)
    return maxima[np.argsort(-values[maxima], kind="stable")[:MAXIMA]]


def choose(
    quadratic: Quadratic,
    lawbook: Mapping[str, Sequence[Law]],
    names: Sequence[str],
    starts: Mapping[str, float] | None = None,
) -> list[Choice]:
    """Return the choices of a law for each effect with columns, the best first.

    Parameters
    ----------
    quadratic : Quadratic
        Quadratic form of their candidates at given noise parameters.
    lawbook : mapping of str to sequence of Law
        The laws of each effect.
    names : sequence of str
        Effects.
    starts : mapping of str to float, or None
        Start for the shape of each law, by ``effect:law``.
    """
    starts_by_law = starts or {}

    def start(laws: Sequence[Law]) -> list[float]:
        return [starts_by_law.get(f"{law.effect}:{law.law}", 0.0) for law in laws]

    combinations = list(product(*(lawbook[name] for name in names)))
    if len(names) > 1:
        # Laws that are far behind at these shapes are not followed.
        rough = quadratic.each_value(combinations, [*map(start, combinations)])
        combinations = [
            laws
            for laws, value in zip(combinations, rough, strict=True)
            if value > rough.max() - RULES.followed_within
        ]
    choices = [quadratic.choice(laws, start(laws)) for laws in combinations]
    return sorted(choices, key=lambda choice: -choice.log_evidence)


def log_orthant(mean: Array, covariance: Array) -> float:
    """Return the log probability that all normal variables are positive.

    Parameters
    ----------
    mean : ndarray, shape (k,)
    covariance : ndarray, shape (k, k)
    """
    sd = np.sqrt(np.diag(covariance))
    marginals = log_ndtr(mean / sd)
    if mean.size < 2 or marginals.min() > -1e-6:
        return float(marginals.sum())
    if marginals.min() < -25.0:
        # Far in the tail: one variable after another, with moments matched to the former ones.
        return _sequential(mean, covariance)
    correlation = covariance / np.outer(sd, sd)
    if mean.size == 2:
        first, second = map(float, mean / sd)
        chance = _quadrant(first, second, float(correlation[0, 1]))
    else:
        chance = float(
            scipy.stats.multivariate_normal.cdf(
                mean / sd,
                np.zeros(mean.size),
                correlation,
                allow_singular=True,
                rng=np.random.default_rng(0),
            )
        )
    return float(np.log(chance)) if chance > 0 else _sequential(mean, covariance)


def _quadrant(first: float, second: float, correlation: float) -> float:
    """Return the probability that two normal variables of unit variance are positive.

    By D. B. Owen's function T (Annals of Mathematical Statistics 27, 1956, 1075): SciPy's own
    distributions take a second and 70 MiB to load.

    Parameters
    ----------
    first, second : float
        Their means; a mean of 0 is treated as a limit.
    correlation : float
        Their correlation.
    """
    h, k = (mean if abs(mean) > NEAREST else NEAREST for mean in (first, second))
    apart = np.sqrt(max((1 - correlation) * (1 + correlation), NEAREST**2))
    tails = owens_t(h, (k / h - correlation) / apart) + owens_t(k, (h / k - correlation) / apart)
    return float((ndtr(h) + ndtr(k) - (h * k < 0)) / 2 - tails)


def _sequential(mean: Array, covariance: Array) -> float:
    """Return the same by truncated normals with matched moments, one variable at a time."""
    mean, covariance, total = mean.copy(), covariance.copy(), 0.0
    left = list(range(mean.size))
    while left:
        worst = min(left, key=lambda i: mean[i] / np.sqrt(covariance[i, i]))
        sd = np.sqrt(covariance[worst, worst])
        z = mean[worst] / sd
        total += float(log_ndtr(z))
        ratio = float(np.exp(-0.5 * z**2 - 0.5 * np.log(2 * np.pi) - log_ndtr(z)))
        gain = covariance[:, worst] / sd
        mean = mean + gain * ratio
        covariance = covariance - np.outer(gain, gain) * ratio * (ratio + z)
        left.remove(worst)
    return total


def _inverse(whole: Array) -> Array:
    """Return the inverses of precisions (M, k, k) that include a unit prior.

    No eigenvalue is below 1. If rounding of large numbers violates this, it is set to 1.
    """
    inverse = np.linalg.inv(whole)
    lost = (np.diagonal(inverse, axis1=1, axis2=2) <= 0).any(axis=1)
    if lost.any():
        values, vectors = np.linalg.eigh(whole[lost])
        inverse[lost] = (vectors / np.maximum(values, 1.0)[:, None, :]) @ vectors.swapaxes(1, 2)
    return np.asarray(inverse)

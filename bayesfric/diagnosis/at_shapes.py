"""Joint draws of a hypothesis' numbers and of the unknown shapes of its effects."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
from scipy.linalg import solve_triangular
from scipy.special import log_ndtr

from bayesfric.arrays import Array
from bayesfric.diagnosis.discrepancy import Wide
from bayesfric.diagnosis.forms import FormShare
from bayesfric.diagnosis.left_open import sized_places
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.shape_grid import refined_grid
from bayesfric.diagnosis.shapes import WIDEST
from bayesfric.diagnosis.weighing import Weighed
from bayesfric.effects.candidates import is_positive
from bayesfric.inference.information import Information

MEANS = 5  # shapes at which the mean of a hypothesis' numbers is computed


def numbers_at_shapes(
    model: LinearModel,
    weighed: Weighed,
    wide: Wide | None,
    forms: Mapping[str, FormShare],
    drawn: Array,
    rng: np.random.Generator,
) -> tuple[Array, list[Array]]:
    """Return draws of a hypothesis' numbers, moved to shapes that are drawn jointly.

    Numbers that are drawn at the best shape move as their mean moves with the shape: the torque
    of a weight and the offset depend on the unknown angle of its lever. The mean is conditional
    on the small terms of that draw (smooth forces and small amounts of other effects). If these
    terms could have their full prior rms, a small amount of a lever at another angle would
    describe what the angle changes, and torque and offset would move too little.

    Parameters
    ----------
    model, weighed
        The hypothesis.
    wide, forms
        As of ``model.prior``.
    drawn : ndarray, shape (S, p)
        Numbers at the best shapes.
    rng : Generator
        Source of randomness.

    Returns
    -------
    numbers : ndarray, shape (S, p)
    shapes : list of ndarray, shape (S,) or (0,)
        Of each effect with columns, as normal quantiles; empty for a law without a shape.
    """
    acting, psi = weighed.acting, weighed.at.psi
    places = [place for law in acting.laws for place in law.places]
    said = model.information_on(psi, places, acting.phases)
    given = _Given(model, weighed, wide, forms, drawn)

    def at(column: int, quantile: float) -> tuple[Array, Array]:
        shapes_there = (*acting.shapes[:column], quantile, *acting.shapes[column + 1 :])
        moved_acting = replace(acting, shapes=shapes_there)
        return given.at(model.mixed(said, places, moved_acting))

    numbers, shapes = drawn.copy(), [np.empty(0)] * len(acting.laws)
    for column, law in enumerate(acting.laws):
        if not law.has_shape:
            continue

        def log_evidence(shape: float, column: int = column) -> Array:
            return at(column, shape)[1]

        shapes[column] = quantiles = _drawn_shapes(log_evidence, acting.shapes[column], rng)
        nodes = np.linspace(quantiles.min(), quantiles.max(), MEANS)
        moves = np.stack([at(column, float(node))[0] for node in nodes])
        moves -= at(column, acting.shapes[column])[0]
        near = [np.interp(quantiles, nodes, unit) for unit in np.eye(MEANS)]
        numbers[:, given.rest] += np.einsum("ns,nsr->sr", near, moves)
    for place in given.positive:
        numbers[:, place] = np.abs(numbers[:, place])
    return numbers, shapes


class _Given:
    """Conditional law and amplitudes, given draws of the small terms and of their sizes."""

    def __init__(
        self,
        model: LinearModel,
        weighed: Weighed,
        wide: Wide | None,
        forms: Mapping[str, FormShare],
        drawn: Array,
    ) -> None:
        laws = weighed.acting.laws
        mean, sd = model.prior([model.amplitude_prior(law) for law in laws], wide, forms)
        self.rest = np.delete(np.arange(sd.size), sized_places(model, len(laws)))
        self.positive = [
            int(place)
            for place, law in zip(model.places(len(laws)), laws, strict=True)
            if is_positive(model.amplitude_prior(law))
        ]
        self._sd, self._around = sd[self.rest], drawn.copy()
        self._around[:, self.rest] = mean[self.rest]

    def at(self, information: Information) -> tuple[Array, Array]:
        """Return conditional means, (S, r), and the log evidence up to a constant, (S,)."""
        rest, sd = self.rest, self._sd
        pulled = self._around @ information.precision
        density = self._around @ information.slope - 0.5 * (pulled * self._around).sum(axis=1)
        within = sd[:, None] * information.precision[np.ix_(rest, rest)] * sd
        factor = np.linalg.cholesky(within + np.eye(rest.size))
        slope = sd * (information.slope - pulled)[:, rest]
        half = solve_triangular(factor, slope.T, lower=True)
        means = self._around[:, rest] + sd * solve_triangular(factor.T, half, lower=False).T
        density += 0.5 * (half**2).sum(axis=0) - np.log(np.diag(factor)).sum()
        inverse = solve_triangular(factor, np.eye(rest.size), lower=True)
        errors = sd * np.sqrt((inverse**2).sum(axis=0))
        for place in np.searchsorted(rest, self.positive):
            density += log_ndtr(means[:, place] / errors[place])
        return means, density


def _drawn_shapes(
    log_evidence: Callable[[float], Array], best: float, rng: np.random.Generator
) -> Array:
    """Draw a shape for each draw of the small terms, (S,), from log evidences of shapes."""
    grid, weights = refined_grid(
        lambda shapes: np.stack([log_evidence(float(shape)) for shape in shapes]), best
    )
    reached = np.cumsum(weights, axis=0)
    picked = (reached < rng.uniform(size=weights.shape[1])).sum(axis=0)
    shapes = grid[np.minimum(picked, grid.size - 1)]
    shapes = shapes + (grid[1] - grid[0]) * rng.uniform(-0.5, 0.5, shapes.size)
    return np.asarray(np.clip(shapes, -WIDEST, WIDEST))

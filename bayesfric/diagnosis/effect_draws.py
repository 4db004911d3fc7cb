"""Draws of strengths, amplitudes and shapes of effects, hypothesis after hypothesis."""

from collections.abc import Mapping, Sequence

import numpy as np

from bayesfric.arrays import Array
from bayesfric.diagnosis.acting import Acting, Law
from bayesfric.diagnosis.discrepancy import Wide, relative_rms
from bayesfric.diagnosis.forms import FormShare
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.residuals import Residuals
from bayesfric.diagnosis.shape_grid import refined_grid
from bayesfric.diagnosis.shapes import WIDEST, Quadratic
from bayesfric.diagnosis.weighing import Weighed
from bayesfric.inference.priors import from_normal

DRAWS = 1000


class EffectDraws:
    """Collects draws of each effect, hypothesis after hypothesis; names as in ``Posterior``.

    Parameters
    ----------
    model : LinearModel
        The model in which the hypotheses were compared.
    residuals : Residuals
        Windows of that model.
    """

    def __init__(self, model: LinearModel, residuals: Residuals) -> None:
        self._model, self._residuals = model, residuals
        self.strengths: dict[str, Array] = {}
        self.left: dict[str, list[float]] = {}
        self.amplitudes: dict[str, list[Array]] = {}
        self.shapes: dict[str, list[Array]] = {}
        self.waves: dict[str, list[Array]] = {}

    def take_columns(
        self,
        rows: slice,
        own: LinearModel,
        weighed: Weighed,
        drawn: Array,
        numbers: Array,
        shapes: Sequence[Array],
    ) -> None:
        """Store draws of effects with columns under a hypothesis.

        Parameters
        ----------
        rows : slice
            Indices of the n draws.
        own : LinearModel
            The model of the hypothesis.
        weighed : Weighed
            The hypothesis.
        drawn, numbers : ndarray, shape (n, p)
            Its numbers at the best shapes, and at the drawn shapes.
        shapes : sequence of ndarray
            From :func:`drawn_shapes`.
        """
        model, residuals, full = self._model, self._residuals, self._model.full.layout
        acting = weighed.acting
        places = own.places(len(acting.laws))
        columns = residuals.columns[:, full.own : full.own + full.candidates]
        for column, law in enumerate(acting.laws):
            values = drawn[:, places[column]]
            mixed = columns @ model.mixing(acting)[:, column]
            strength, felt = _strength(residuals, mixed)
            if "period" in model.candidates[law.places[0]].effect.needs:
                self.waves.setdefault(law.effect, []).append(mixed)
            self._keep(rows, law, strength * np.abs(values), felt * float(np.abs(values).mean()))
            amplitude = numbers[:, places[column]] * model.amplitude_scale(law)
            self.amplitudes.setdefault(law.effect, []).append(amplitude)
            self.shapes.setdefault(law.effect, []).append(shape_values(own, law, shapes[column]))

    def take_phases(
        self,
        rows: slice,
        own: LinearModel,
        weighed: Weighed,
        wide: Wide | None,
        forms: Mapping[str, FormShare],
        rng: np.random.Generator,
    ) -> Array:
        """Store draws of effects with phases, and return the mean square of their force [N²]."""
        model, acting, at = self._model, weighed.acting, weighed.at
        hidden2 = np.zeros(rows.stop - rows.start)
        for place, law in enumerate(acting.phases):
            middle = at.psi[len(model.noise) + place]
            spread = _log_spread(own, at.psi, acting, place, wide, forms)
            values = np.exp(middle + spread * rng.standard_normal(hidden2.size))
            self.amplitudes.setdefault(law.effect, []).append(values)
            share = values * _phase_share(model, law.places[0])
            real = model.candidates[law.places[0]].effect.acts_on != "reading"
            self._keep(rows, law, share, float(share.mean()) if real else 0.0)
            if real:
                hidden2 = hidden2 + (share * self._residuals.friction_rms) ** 2
        return hidden2

    def _keep(self, rows: slice, law: Law, strength: Array, left: float) -> None:
        """Store draws of an effect's strength, and the part that a recalibrated law leaves."""
        self.strengths.setdefault(law.effect, np.zeros(DRAWS))[rows] = strength
        self.left.setdefault(law.effect, []).append(left)


def _strength(residuals: Residuals, column: Array) -> tuple[float, float]:
    """Return the rms force relative to rms friction, and the part that a refitted law leaves."""
    rigs = [rig for rig in np.unique(residuals.rig) if np.any(column[residuals.rig == rig])]
    on_rigs = np.isin(residuals.rig, rigs)
    weight = residuals.weight * on_rigs
    friction2 = (weight * residuals.friction_n**2).sum()
    if friction2 == 0:
        return 0.0, 0.0
    left = residuals.without_law(column)
    return (
        float(np.sqrt((weight * column**2).sum() / friction2)),
        float(np.sqrt((residuals.weight * left**2).sum()) / residuals.friction_rms),
    )


def _phase_share(model: LinearModel, place: int) -> float:
    """Return the rms force of phases of unit amplitude, relative to friction."""
    return relative_rms([rig.rows for rig in model.rigs], model.candidates[place])


def _log_spread(
    model: LinearModel,
    psi: Array,
    acting: Acting,
    place: int,
    wide: Wide | None,
    form: Mapping[str, FormShare],
) -> float:
    """Return the standard deviation of the logarithm of an amplitude with phases."""
    step = np.zeros_like(psi)
    step[len(model.noise) + place] = 0.1
    below, middle, above = (
        model.evaluate(at, acting, wide, form).value for at in (psi - step, psi, psi + step)
    )
    return float(np.sqrt(0.1**2 / max(2 * middle - below - above, 1e-2 * 0.1**2)))


def drawn_shapes(
    model: LinearModel, weighed: Weighed, count: int, rng: np.random.Generator
) -> list[Array]:
    """Draw the shape of each effect with the other shapes fixed, as normal quantiles.

    Parameters
    ----------
    model : LinearModel
        Of the hypothesis.
    weighed : Weighed
        The hypothesis.
    count : int
        Number S of draws.
    rng : Generator
        Source of randomness.

    Returns
    -------
    list of ndarray, shape (S,) or (0,)
        For each effect with columns; empty for a law without a shape.
    """
    return [
        _shape_draws(model, weighed, column, count, rng) if law.has_shape else np.empty(0)
        for column, law in enumerate(weighed.acting.laws)
    ]


def shape_values(model: LinearModel, law: Law, quantiles: Array) -> Array:
    """Return shape parameters of a law in their own unit, from normal quantiles."""
    shape = model.candidates[law.places[0]].effect.shape
    return np.empty(0) if shape is None else np.asarray(from_normal(shape.prior, quantiles))


def _shape_draws(
    model: LinearModel, weighed: Weighed, column: int, count: int, rng: np.random.Generator
) -> Array:
    """Draw the shape of one effect with the others fixed, as normal quantiles."""
    places = [place for acting_law in weighed.acting.laws for place in acting_law.places]
    reduced = model.reduced(
        weighed.at.psi, Acting(phases=weighed.acting.phases), weighed.forms, places
    )
    quadratic = Quadratic(model, reduced, places)

    def log_evidences(grid: Array) -> Array:
        shapes = [np.array([shape]) for shape in weighed.acting.shapes]
        shapes[column] = grid
        return quadratic.values(weighed.acting.laws, shapes)[:, None]

    grid, weights = refined_grid(log_evidences, weighed.acting.shapes[column])
    picked = rng.choice(grid, size=count, p=weights[:, 0])
    picked = picked + (grid[1] - grid[0]) * rng.uniform(-0.5, 0.5, count)
    return np.asarray(np.clip(picked, -WIDEST, WIDEST))

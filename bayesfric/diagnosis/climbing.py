"""The mode of the noise of a hypothesis, and the curvature at this mode."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from bayesfric.arrays import Array, Flags
from bayesfric.diagnosis.acting import Acting, At
from bayesfric.diagnosis.discrepancy import Wide
from bayesfric.diagnosis.forms import FormShare
from bayesfric.diagnosis.model import LinearModel
from bayesfric.inference.symmetric import eigen_of

STEP = 0.005  # of a log noise parameter, for finite differences of the gradient
LONGEST = 1.0  # longest step of a log noise parameter
ENOUGH = 0.02  # expected gain of a further step at which a climb ends [nat]
STEPS = 30
LEAST_CURVATURE = 0.05  # of a log density along a log noise parameter (its prior is proper)


def climb(
    model: LinearModel,
    psi: Array,
    acting: Acting,
    wide: Wide | None = None,
    form: Mapping[str, FormShare] | None = None,
    inverse: Array | None = None,
) -> At:
    """Climb from given noise parameters to their mode under a hypothesis.

    Parameters
    ----------
    model : LinearModel
        All rigs.
    psi, acting, wide, form
        As of :meth:`~bayesfric.diagnosis.model.LinearModel.evaluate`.
    inverse : ndarray or None
        A first guess of the inverse of the negative Hessian, at least for the noise.
    """
    low, high = _bounds(model, psi.size)

    def evaluated(psi: Array, above: float = -np.inf) -> At:
        """Evaluate the hypothesis at ``psi``, with the Student-t weights of the mode there."""
        nonlocal model
        psi = np.clip(psi, low, high)
        model = model.reweighted(psi, acting, wide, form)
        return model.evaluate(psi, acting, wide, form, gradient=True, above=above)

    at = evaluated(psi)
    guess = np.diag(np.full(psi.size, 0.1))
    if inverse is not None:
        first_numbers = len(inverse)
        guess[:first_numbers, :first_numbers] = inverse
    for _ in range(STEPS):
        assert at.gradient is not None
        free = ((at.psi > low) | (at.gradient > 0)) & ((at.psi < high) | (at.gradient < 0))
        slope = np.where(free, at.gradient, 0.0)
        step = np.where(free, guess @ slope, 0.0)
        if step @ slope <= 0:
            guess = np.diag(np.full(psi.size, 0.1))
            step = guess @ slope
        if step @ slope / 2 < ENOUGH:
            return replace(at, at_mode=True)
        step *= min(1.0, LONGEST / np.abs(step).max())
        for _ in range(8):
            there = evaluated(at.psi + step, at.value + 1e-4 * float(slope @ step))
            if there.gradient is not None:
                break
            step *= 0.3
        else:
            break
        assert there.gradient is not None
        # A parameter at its bound gives no information on the curvature of the others.
        change = np.where(free, at.gradient - there.gradient, 0.0)
        guess = _bfgs(guess, np.where(free, there.psi - at.psi, 0.0), change)
        at = there
    return at


def at_bounds(model: LinearModel, psi: Array) -> Flags:
    """Return which log noise parameters are at a bound."""
    low, high = _bounds(model, psi.size)
    return np.asarray((psi <= low) | (psi >= high))


def curvature_at(
    model: LinearModel, at: At, acting: Acting, form: Mapping[str, FormShare] | None = None
) -> Array:
    """Return the negative Hessian of the log density in the log noise, with no flat direction."""

    def gradient(psi: Array) -> Array:
        own = model.reweighted(psi, acting, None, form)
        slopes = own.evaluate(psi, acting, None, form, gradient=True).gradient
        assert slopes is not None
        return slopes

    slope = gradient(at.psi)
    moved = [gradient(at.psi + STEP * along) for along in np.eye(at.psi.size)]
    hessian = (np.array(moved) - slope) / STEP
    values, vectors = eigen_of(-0.5 * (hessian + hessian.T))
    return np.asarray((vectors * np.maximum(values, LEAST_CURVATURE)) @ vectors.T)


def _bounds(model: LinearModel, count: int) -> tuple[Array, Array]:
    pairs = [parameter.bounds for parameter in model.noise]
    pairs += [(1e-7, 10.0)] * (count - len(pairs))
    low, high = np.log(np.array(pairs)).T
    return low, high


def _bfgs(inverse: Array, step: Array, change: Array) -> Array:
    """Return the inverse of a negative Hessian once a step has changed the gradient."""
    along = float(step @ change)
    if along <= 1e-10:
        return inverse
    left = np.eye(step.size) - np.outer(step, change) / along
    return np.asarray(left @ inverse @ left.T + np.outer(step, step) / along)

"""The law recalibrated to the forces in windows, and the residuals that chance makes."""

from dataclasses import dataclass

import numpy as np

from bayesfric.arrays import Array, Flags
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.residuals import Residuals
from bayesfric.inference.symmetric import root_of
from bayesfric.observation.layout import COEFFICIENTS


@dataclass(frozen=True)
class Refit:
    """How the law of a model follows the forces of some windows.

    Parameters
    ----------
    design : ndarray, shape (R, p)
        What the coefficients of all sizes do in each window, in units of their prior [N].
    smoothing : ndarray, shape (p, R)
        What turns residual forces into moves of these coefficients.
    mean, sd : ndarray, shape (p,)
        Of the coefficients before the data.
    """

    design: Array
    smoothing: Array
    mean: Array
    sd: Array

    def kept(self, values: Array) -> Array:
        """Return what of forces, (R, k), the refitted law does not take up."""
        return np.asarray(values - self.design @ (self.smoothing @ values))

    def chance2(self, residuals: Residuals, further: Array) -> Array:
        """Return the mean square that chance leaves in each window, shape (R,) [N²].

        Measurement and friction's scatter are left in the window, and both have moved the
        law. Where a window has moved the law by itself, less is left of it.

        Parameters
        ----------
        residuals : Residuals
            The windows.
        further : ndarray, shape (R, k)
            Forces of unit variance that the numbers beside the law are uncertain by [N].
        """
        moved = residuals.scattered(self.smoothing.T)
        of_law = self.smoothing @ moved
        variance = residuals.chance2 - 2 * (self.design * moved).sum(axis=1)
        variance += ((self.design @ of_law) * self.design).sum(axis=1)
        return np.asarray(variance + (self.kept(further) ** 2).sum(axis=1))

    def spread(self, residuals: Residuals, further: Array) -> Array:
        """Return columns whose outer product is the covariance of the coefficients, (p, k)."""
        covariance = self.smoothing @ residuals.scattered(self.smoothing.T)
        own = root_of(0.5 * (covariance + covariance.T))
        return np.asarray(self.sd[:, None] * np.hstack([own, -self.smoothing @ further]))


def refit_of(model: LinearModel, residuals: Residuals, rows: Flags) -> Refit:
    """Return how the law follows the forces of some windows.

    Least squares with the weights of the gap, less where the measurement is poor, and the
    prior of the law: what a force that the law does not have does within a trial does not
    bend the law, as it would if events were taken to be as precise as they are.

    Parameters
    ----------
    model : LinearModel
        Without discrepancy.
    residuals : Residuals
        Of its windows.
    rows : ndarray of bool, shape (R,)
        Those that enter; without any the law is that of the prior.
    """
    sizes = len(model.layout.sizes)
    mean, sd = (moments[: COEFFICIENTS * sizes] for moments in model.prior(()))
    design = np.zeros((rows.size, COEFFICIENTS * sizes))
    for size in range(sizes):
        mine = residuals.size == size
        place = slice(COEFFICIENTS * size, COEFFICIENTS * (size + 1))
        design[mine, place] = residuals.columns[mine, :COEFFICIENTS]
    design *= sd
    if not rows.any():
        return Refit(design, np.zeros(design.T.shape), mean, sd)
    spread2 = residuals.friction_n**2 * residuals.spread2
    weight = residuals.weight * rows * spread2 / (spread2 + residuals.variance)
    # An assembly's scatter enters once, however many windows there are of it.
    assemblies = np.unique(residuals.setup[rows]).size
    variance = (weight * (spread2 + residuals.variance)).sum()
    certainty = assemblies / variance * weight[:, None] * design
    precision = design.T @ certainty + np.eye(COEFFICIENTS * sizes)
    try:
        follows = np.linalg.solve(precision, certainty.T)
    except np.linalg.LinAlgError:
        # Data so much surer than the prior that rounding leaves nothing of it: by roots of both.
        root = np.sqrt(assemblies / variance * weight)
        both = np.concatenate([root[:, None] * design, np.eye(COEFFICIENTS * sizes)])
        follows = np.linalg.pinv(both)[:, : rows.size] * root
    return Refit(design, follows, mean, sd)


def recalibrated(refit: Refit, residuals: Residuals, local: Array) -> Array:
    """Return local numbers with the law that fits the forces of some windows best.

    Parameters
    ----------
    refit : Refit
        How the law follows the windows.
    residuals : Residuals
        Of all windows.
    local : ndarray, shape (sizes, q)
        The law's are left aside, the others held.
    """
    moved_local = local.copy()
    moved_local[:, :COEFFICIENTS] = refit.mean.reshape(-1, COEFFICIENTS)
    moved = refit.sd * (refit.smoothing @ residuals.left(moved_local))
    moved_local[:, :COEFFICIENTS] += moved.reshape(-1, COEFFICIENTS)
    return moved_local

"""The law recalibrated to forces in windows, and the expected residuals of a correct law."""

from dataclasses import dataclass

import numpy as np

from bayesfric.arrays import Array, Flags
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.residuals import Residuals
from bayesfric.inference.symmetric import root_of
from bayesfric.observation.layout import COEFFICIENTS


@dataclass(frozen=True)
class Refit:
    """The linear map from forces in windows to the coefficients of the law.

    Parameters
    ----------
    design : ndarray, shape (R, p)
        Force of the coefficients of all sizes in each window, in units of their prior sd [N].
    smoothing : ndarray, shape (p, R)
        Map from residual forces to changes of these coefficients.
    mean, sd : ndarray, shape (p,)
        Prior moments of the coefficients.
    """

    design: Array
    smoothing: Array
    mean: Array
    sd: Array

    def kept(self, values: Array) -> Array:
        """Return the part of forces, (R, k), that the refitted law leaves."""
        return np.asarray(values - self.design @ (self.smoothing @ values))

    def chance2(self, residuals: Residuals, further: Array) -> Array:
        """Return the expected squared residual of a correct law in each window, shape (R,) [N²].

        It contains measurement error and scatter of friction, in the window and in the refitted
        law. A window that influences its own fit has a smaller residual.

        Parameters
        ----------
        residuals : Residuals
            The windows.
        further : ndarray, shape (R, k)
            Force in each window of one posterior standard deviation of the other numbers [N].
        """
        moved = residuals.scattered(self.smoothing.T)
        of_law = self.smoothing @ moved
        variance = residuals.chance2 - 2 * (self.design * moved).sum(axis=1)
        variance += ((self.design @ of_law) * self.design).sum(axis=1)
        return np.asarray(variance + (self.kept(further) ** 2).sum(axis=1))

    def spread(self, residuals: Residuals, further: Array) -> Array:
        """Return a root of the coefficients' covariance, (p, k)."""
        covariance = self.smoothing @ residuals.scattered(self.smoothing.T)
        own = root_of(0.5 * (covariance + covariance.T))
        return np.asarray(self.sd[:, None] * np.hstack([own, -self.smoothing @ further]))


def refit_of(model: LinearModel, residuals: Residuals, rows: Flags) -> Refit:
    """Return the map from forces in some windows to the coefficients.

    It is least squares with the weights of the gap, reduced where the measurement is poor, and
    the prior of the law. With weights by the precision of events, a force within a trial that
    the law lacks would bias the law.

    Parameters
    ----------
    model : LinearModel
        Model without discrepancy.
    residuals : Residuals
        Residuals of its windows.
    rows : ndarray of bool, shape (R,)
        Windows that are used; without any, the law is the prior mean.
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
    # The scatter of an assembly counts once, for any number of its windows.
    assemblies = np.unique(residuals.setup[rows]).size
    variance = (weight * (spread2 + residuals.variance)).sum()
    certainty = assemblies / variance * weight[:, None] * design
    precision = design.T @ certainty + np.eye(COEFFICIENTS * sizes)
    try:
        follows = np.linalg.solve(precision, certainty.T)
    except np.linalg.LinAlgError:
        # Data can be so precise that the prior is lost by rounding; roots of both avoid this.
        root = np.sqrt(assemblies / variance * weight)
        both = np.concatenate([root[:, None] * design, np.eye(COEFFICIENTS * sizes)])
        follows = np.linalg.pinv(both)[:, : rows.size] * root
    return Refit(design, follows, mean, sd)


def recalibrated(refit: Refit, residuals: Residuals, local: Array) -> Array:
    """Return local numbers with the coefficients refitted to forces in windows.

    Parameters
    ----------
    refit : Refit
        The map from forces to coefficients.
    residuals : Residuals
        Residuals of all windows.
    local : ndarray, shape (sizes, q)
        Numbers whose coefficients are replaced; the other numbers are fixed.
    """
    moved_local = local.copy()
    moved_local[:, :COEFFICIENTS] = refit.mean.reshape(-1, COEFFICIENTS)
    moved = refit.sd * (refit.smoothing @ residuals.left(moved_local))
    moved_local[:, :COEFFICIENTS] += moved.reshape(-1, COEFFICIENTS)
    return moved_local

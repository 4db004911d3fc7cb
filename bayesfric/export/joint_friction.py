"""Friction in the form of rigid-body simulators: a constant against the motion, and damping."""

from dataclasses import dataclass

import numpy as np
import scipy

from bayesfric.arrays import Array
from bayesfric.export.stored_law import StoredLaw
from bayesfric.inference.clustered import clustered_covariance

ROUNDING = 1e-9  # relative to friction


@dataclass(frozen=True)
class JointFriction:
    """The best constant and damping, and their error.

    Parameters
    ----------
    frictionloss : float
        Coulomb friction [N or N·m].
    damping : float
        Friction per speed [N s/m or N·m s/rad].
    frictionloss_sd, damping_sd : float
        Their standard deviations.
    error_rms, error_max : float
        Their deviation from the law with the causes, at the measured conditions.
    friction_rms : float
        Rms friction of that law.
    """

    frictionloss: float
    damping: float
    frictionloss_sd: float
    damping_sd: float
    error_rms: float
    error_max: float
    friction_rms: float

    @property
    def said(self) -> str:
        """The error of the two numbers, in a sentence."""
        if self.error_rms <= ROUNDING * self.friction_rms:
            return "Constant and damping are those of the law itself."
        return (
            f"Constant and damping miss the diagnosed law by {self.error_rms:.3g} rms and "
            f"{self.error_max:.3g} at most, {self.error_rms / self.friction_rms:.2%} of friction "
            f"in the mean, over the recording's own conditions."
        )


def joint_friction(law: StoredLaw) -> JointFriction:
    """Return the non-negative constant and damping that fit the law best.

    They are a least-squares fit over the conditions at which friction was measured. All dependence
    on tension, pulleys or other powers of speed counts as error. Their standard deviations are
    those of the law's own numbers, if it has these. Otherwise they are those of the least squares,
    with trials as clusters.
    """
    speed = np.abs(law.place("velocity"))
    columns = np.stack([np.ones_like(speed), speed], axis=1)
    (constant, damping), _ = scipy.optimize.nnls(columns, law.friction)
    off = law.friction - columns @ np.array([constant, damping])
    constant_sd, damping_sd = _errors(columns, law)
    return JointFriction(
        float(constant),
        float(damping),
        _posterior_sd(law, "coulomb") or constant_sd,
        _posterior_sd(law, "viscous") or damping_sd,
        float(np.sqrt((off**2).mean())),
        float(np.abs(off).max()),
        float(np.sqrt((law.friction**2).mean())),
    )


def _posterior_sd(law: StoredLaw, name: str) -> float:
    """Return the standard deviation of a number of the law; 0 if it has no such number."""
    return law.numbers[name].value.sd if name in law.numbers else 0.0


def _errors(columns: Array, law: StoredLaw) -> tuple[float, float]:
    """Return the errors of both numbers from the residuals of trials (sandwich estimator).

    References
    ----------
    H. White, "A heteroskedasticity-consistent covariance matrix estimator and a direct test for
    heteroskedasticity", Econometrica 48 (1980); with the trials as clusters.
    """
    _, trial = np.unique(law.trial, return_inverse=True)
    inverse = np.asarray(np.linalg.pinv(columns.T @ columns))
    covariance = clustered_covariance(columns, law.measured - law.friction, trial, inverse)
    constant, slope = np.sqrt(np.diag(covariance))
    return float(constant), float(slope)

"""Residual forces of a correct law, drawn with measurement error and the scatter of friction."""

import numpy as np

from bayesfric.arrays import Array
from bayesfric.diagnosis.residuals import Residuals
from bayesfric.inference.symmetric import root_of


def redrawn(residuals: Residuals, count: int, rng: np.random.Generator) -> Array:
    """Draw residual forces of a perfect law, shape (R, count) [N].

    Parameters
    ----------
    residuals : Residuals
        Contains the covariances of measurement and wander, and the scatter of trials and
        assemblies.
    count : int
        Number of draws.
    rng : Generator
        Source of randomness.
    """
    tau, omega = np.sqrt(residuals.scatter[:, :1]), np.sqrt(residuals.scatter[:, 1:])
    setups, trials = residuals.setup.max() + 1, residuals.trial.max() + 1
    of_setups, of_trials = (rng.standard_normal((number, count)) for number in (setups, trials))
    drawn, start = np.empty((residuals.setup.size, count)), 0
    for part, wander in zip(residuals.covariance, residuals.wander, strict=True):
        rows = slice(start, start + len(part))
        friction = residuals.friction_n[rows]
        root = root_of(part + wander * np.outer(friction, friction))
        relative = omega[rows] * of_setups[residuals.setup[rows]]
        relative += tau[rows] * of_trials[residuals.trial[rows]]
        drawn[rows] = relative * friction[:, None] + root @ rng.standard_normal((len(part), count))
        start = rows.stop
    return drawn

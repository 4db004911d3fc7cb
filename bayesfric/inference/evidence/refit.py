"""The posterior without one group of the data, sampled anew.

Where the weights of leave-one-out fail, the group decides so much that draws of the
posterior of all data are of no use. The density without it is known all the same,

    p(θ | y_−g) ∝ p(θ | y) / p(y_g | y_−g, θ),

so no model is built again: the mode is climbed to from that of all the data, and the
density is sampled around it by importance.

References
----------
P.-C. Bürkner, J. Gabry, A. Vehtari, "Efficient leave-one-out cross-validation for
Bayesian non-factorized normal and Student-t models", Computational Statistics 36
(2021).
"""

from dataclasses import dataclass

import numpy as np

from bayesfric.arrays import Array
from bayesfric.inference.evidence.importance import LEAST_FOR_A_MEAN, importance_draws
from bayesfric.inference.evidence.record import Evidence
from bayesfric.inference.laplace import laplace_approximation
from bayesfric.inference.proposals import SAMPLING_SPACE, Chart, LogDensity

SIZE = 2000  # of the draws


@dataclass(frozen=True)
class Refit:
    """A posterior without one of its groups.

    Parameters
    ----------
    draws : ndarray, shape (S, D)
        Of it.
    evidence : Evidence
        Of the data without the group, on the scale of the log density that was given.
    """

    draws: Array
    evidence: Evidence


def refit_without(
    log_density: LogDensity,
    log_conditional: LogDensity,
    start: Array,
    scale: Array,
    seed: int,
    chart: Chart = SAMPLING_SPACE,
) -> Refit | None:
    """Sample a posterior without one of its groups.

    Parameters
    ----------
    log_density : callable
        Unnormalised log posterior of all data; points of shape (W, D) to shape (W,).
    log_conditional : callable
        log p(y_g | y_−g, θ) of the group, likewise.
    start : ndarray, shape (D,)
        A point of finite density, such as the draw with the highest.
    scale : ndarray, shape (D,)
        Widest plausible scale of each coordinate, such as its prior's.
    seed : int
        Of the draws.
    chart : Chart
        In which a proposal is fitted.

    Returns
    -------
    Refit or None
        None where importance sampling is not to be relied on.
    """

    def without(points: Array) -> Array:
        density = log_density(points)
        rest = np.full(density.shape, -np.inf)
        possible = np.isfinite(density)
        if possible.any():
            rest[possible] = density[possible] - log_conditional(points[possible])
        return np.where(rest < np.inf, rest, -np.inf)

    laplace = laplace_approximation(without, start, scale)
    drawn = importance_draws(without, laplace, seed, chart, SIZE, least_effective=LEAST_FOR_A_MEAN)
    return None if drawn is None else Refit(drawn[1], drawn[0])

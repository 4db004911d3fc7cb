"""Student-t trial scatter: the robust alternative to :mod:`.scatter`.

Around the friction ``μ_j (1 + η)`` of its assembly a trial's observed friction is
Student-t with the squared scale ``(μ_j τ)² + v_j``. Folding the measurement
variance v_j into the scale is exact where it is small beside the scatter, as it
is for Hall events. The assembly's η ~ N(0, ω²) is integrated by the trapezoid
rule on a grid around its posterior.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaln, logsumexp, stdtr

from bayesfric.inference.scatter import LOG_2PI, SetupIndex

__all__ = ["student_setup_log_density", "student_trial_cdf", "student_trial_log_density"]

Array = NDArray[np.float64]
REWEIGHTINGS = 12
HALF_WIDTH = 8.0  # of the grid, in standard deviations
SETUP_NODES = 41
TRIAL_NODES = 161


def student_setup_log_density(
    index: SetupIndex,
    observed: Array,
    variance: Array,
    mu: Array,
    tau: Array,
    omega: Array,
    *,
    freedom: float,
) -> Array:
    """Return the log density of each assembly's observed friction.

    Parameters
    ----------
    index : SetupIndex
        N trials in J assemblies.
    observed, variance : ndarray, shape (…, N)
        Observed friction [N] and the variance of its measurement error [N²].
    mu : ndarray, shape (…, N)
        Friction of the law [N].
    tau, omega : ndarray, broadcastable to (…, N)
        Scale of a trial's scatter and sd of an assembly's, both relative.
    freedom : float
        Degrees of freedom of the Student-t.

    Returns
    -------
    ndarray, shape (…, J)
        Joint log density of the trials of each assembly.
    """
    log_weight, trial, _ = _on_grid(
        index, observed, variance, mu, tau, omega, freedom, SETUP_NODES, leave_out=False
    )
    return logsumexp(log_weight + index.total(trial), axis=0)


def student_trial_log_density(
    index: SetupIndex,
    observed: Array,
    variance: Array,
    mu: Array,
    tau: Array,
    omega: Array,
    *,
    freedom: float,
) -> Array:
    """Return the log density of each trial given the other trials of its assembly.

    The arguments are those of :func:`student_setup_log_density`.

    Returns
    -------
    ndarray, shape (…, N)
        ``log p(y_j | y_−j)``.
    """
    log_weight, trial, _ = _on_grid(
        index, observed, variance, mu, tau, omega, freedom, TRIAL_NODES, leave_out=True
    )
    together = (log_weight + index.total(trial))[..., index.of_trial]
    return logsumexp(together, axis=0) - logsumexp(together - trial, axis=0)


def student_trial_cdf(
    index: SetupIndex,
    observed: Array,
    variance: Array,
    mu: Array,
    tau: Array,
    omega: Array,
    *,
    freedom: float,
) -> Array:
    """Return the probability of a lower friction of each trial given its assembly's others.

    The arguments are those of :func:`student_setup_log_density`.

    Returns
    -------
    ndarray, shape (…, N)
        ``P(Y_j ≤ y_j | y_−j)``.
    """
    log_weight, trial, distance = _on_grid(
        index, observed, variance, mu, tau, omega, freedom, TRIAL_NODES, leave_out=True
    )
    rest = (log_weight + index.total(trial))[..., index.of_trial] - trial
    weight = np.exp(rest - rest.max(axis=0))
    weight /= weight.sum(axis=0)
    return np.asarray((weight * stdtr(freedom, distance)).sum(axis=0))


def _on_grid(
    index: SetupIndex,
    observed: Array,
    variance: Array,
    mu: Array,
    tau: Array,
    omega: Array,
    freedom: float,
    nodes: int,
    *,
    leave_out: bool,
) -> tuple[Array, Array, Array]:
    """Return the log prior weight of η, (Q, …, J), and of trials, (Q, …, N), two things.

    These are the log density, and the distance from the centre in units of the scale.
    """
    scale2 = (mu * tau) ** 2 + variance
    residual = observed - mu
    omega2 = np.broadcast_to(omega, mu.shape)[..., index.starts] ** 2
    centre = np.zeros_like(omega2)
    for _ in range(REWEIGHTINGS):  # iteratively reweighted least squares
        off = residual - mu * centre[..., index.of_trial]
        weight = (freedom + 1) / (freedom + off**2 / scale2) / scale2
        information = weight * mu**2
        precision = 1 / omega2 + index.total(information)
        centre = index.total(weight * mu * residual) / precision
    if leave_out:  # wide enough for the posterior without the most telling trial
        precision = precision - np.maximum.reduceat(information, index.starts, axis=-1)
    step = 2 * HALF_WIDTH / (nodes - 1) / np.sqrt(precision)
    place = np.arange(nodes) - (nodes - 1) / 2
    eta = centre + step * place.reshape(-1, *np.ones(centre.ndim, dtype=int))
    log_weight = np.log(step) - 0.5 * (LOG_2PI + np.log(omega2) + eta**2 / omega2)
    distance = (residual - mu * eta[..., index.of_trial]) / np.sqrt(scale2)
    trial = (
        gammaln((freedom + 1) / 2)
        - gammaln(freedom / 2)
        - 0.5 * np.log(freedom * np.pi * scale2)
        - 0.5 * (freedom + 1) * np.log1p(distance**2 / freedom)
    )
    return log_weight, trial, distance

"""Scatter in the linear model of the gravity board: random columns and noise parameters."""

from functools import partial

import numpy as np

from bayesfric.analysis import Prior, Priors
from bayesfric.arrays import Array
from bayesfric.inference.cosines import cosine_variances, log_variance_slopes
from bayesfric.inference.priors import log_density
from bayesfric.observation.linear import NoiseParameter, noise_parameter
from bayesfric.rigs.gravity_board.event_columns import ROUGH_SD

WAVES = 20  # cosines along the travel; half a wave of the last one is 3 cm for a travel of 0.6 m
# Places of the random columns: deviation of all friction and of the intercept, cosines of the
# wander, travel before the first event, variation of an error of one sensor, clock offset.
TRIAL, INTERCEPT, WANDER, RELEASE = 0, 1, slice(2, 2 + WAVES), 2 + WAVES
UNEVEN, CLOCK = 3 + WAVES, 4 + WAVES
ALWAYS = 5 + WAVES  # number of random columns in every hypothesis
UNEVEN_SHARE = 0.03  # relative variation, between trials, of an error of one sensor
EVENT_SD_M = 30e-6  # standard deviation of an event on a good board
KAPPA_SD_LOG = 0.3  # prior sd of log κ; κ is the variance of events over its first estimate
UNSTATED = (1e-3, 1e4)  # bounds of κ for accelerations without a stated error


def wander_weights(length_m: float, travel_m: float) -> tuple[Array, Array]:
    """Return the variance of each cosine of a wander of unit rms, and its derivative.

    The process is that of :mod:`bayesfric.inference.cosines`. It has more cosines than in a fit,
    because other boards may wander over shorter lengths.

    Parameters
    ----------
    length_m : float
        Correlation length [m].
    travel_m : float
        Longest travel [m].

    Returns
    -------
    variance : ndarray, shape (WAVES,)
        Variance of each cosine's coefficient.
    slope : ndarray, shape (WAVES,)
        Derivative of the logarithm of this variance by the logarithm of the length.
    """
    length = length_m / travel_m
    return cosine_variances(length, WAVES), log_variance_slopes(length, WAVES)


def noise_of(
    priors: Priors, variance_m2: float, *, unstated: bool = False
) -> tuple[NoiseParameter, ...]:
    """Return the noise parameters.

    Parameters
    ----------
    priors : Priors
        Priors of scatter and wander.
    variance_m2 : float
        First estimate of the variance of an event [m²]; ``kappa`` is its factor.
    unstated : bool
        Whether all trials have only an acceleration without a stated error. There is then no
        first estimate, and the prior of ``kappa`` follows from that of ``sigma_a``.
    """
    usual = EVENT_SD_M**2 / variance_m2
    kappa = NoiseParameter("kappa", 1.0, (0.05, 1e4), _log_prior_kappa, usual)
    if unstated:
        log_prior = partial(_log_prior_unstated, priors.sigma_a)
        kappa = NoiseParameter("kappa", 1.0, UNSTATED, log_prior, 1.0)
    return (
        _scatter("tau", priors.tau, 0.01),
        _scatter("omega", priors.omega, 0.015),
        _scatter("omega_intercept", priors.omega_intercept, 0.015),
        _scatter("wander", priors.wander, 0.001, 0.003),
        noise_parameter("wander_length", priors.wander_length, 0.1, (0.04, 0.5), 0.1),
        kappa,
    )


def _scatter(name: str, prior: Prior, usual: float, start: float = 0.012) -> NoiseParameter:
    return noise_parameter(name, prior, start, (1e-4, 1.0), usual, scatters=True)


def _log_prior_unstated(prior: Prior, value: Array) -> Array:
    sd = ROUGH_SD * np.sqrt(value)
    return log_density(prior, sd) + np.log(sd)


def _log_prior_kappa(value: Array) -> Array:
    return np.asarray(-0.5 * (np.log(value) / KAPPA_SD_LOG) ** 2)

"""Scatter in the linear model of the gravity board: its columns and noise parameters."""

from functools import partial

import numpy as np

from bayesfric.analysis import Prior, Priors
from bayesfric.arrays import Array
from bayesfric.inference.cosines import cosine_variances, log_variance_slopes
from bayesfric.inference.priors import log_density
from bayesfric.observation.linear import NoiseParameter, noise_parameter
from bayesfric.rigs.gravity_board.event_rows import ROUGH_SD

WAVES = 20  # cosines along the travel; half the wavelength of the last is 3 cm of 0.6 m
TRIAL, INTERCEPT, WANDER, ELSEWHERE = 0, 1, slice(2, 2 + WAVES), 2 + WAVES
UNEVEN, CLOCK = 3 + WAVES, 4 + WAVES
ALWAYS = 5 + WAVES  # columns that scatter in every hypothesis
UNEVEN_SHARE = 0.03  # by which two sensors disagree otherwise from trial to trial
EVENT_SD_M = 30e-6  # of an event on a good board
KAPPA_SD_LOG = 0.3  # of the events' variance over its first estimate
UNSTATED = (1e-3, 1e4)  # bounds of the same, of accelerations whose error nobody stated


def wander_weights(length_m: float, travel_m: float) -> tuple[Array, Array]:
    """Return the variance of each cosine of a wander of unit rms, and how its log grows.

    The process is that of :mod:`bayesfric.inference.cosines`, cut later than in a fit: boards
    of other hands wander on shorter lengths too.

    Parameters
    ----------
    length_m : float
        Correlation length [m].
    travel_m : float
        Longest travel [m].

    Returns
    -------
    variance : ndarray, shape (WAVES,)
        Of each cosine.
    slope : ndarray, shape (WAVES,)
        Derivative of its logarithm by the logarithm of the length.
    """
    length = length_m / travel_m
    return cosine_variances(length, WAVES), log_variance_slopes(length, WAVES)


def noise_of(
    priors: Priors, variance_m2: float, *, unstated: bool = False
) -> tuple[NoiseParameter, ...]:
    """Return the parameters of the noise.

    Parameters
    ----------
    priors : Priors
        Of scatter and wander.
    variance_m2 : float
        Of an event, by a first estimate [m²]; its factor is ``kappa``.
    unstated : bool
        Whether all trials have an acceleration alone, whose error nobody stated: there is no
        first estimate of it then, but the prior ``sigma_a``.
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

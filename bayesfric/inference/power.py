"""The smallest effect that data would show, from the standard error of its amplitude.

If data determine the amplitude A of an effect with the standard error σ, they give an estimate
Â ~ N(A, σ²). The Bayes factor for the effect follows from the estimate and the prior,

    B(Â) = ∫ N(Â; A, σ²) p(A) dA / N(Â; 0, σ²),

and increases with the estimate. The effect is found if B reaches a threshold, at an estimate a. An
amplitude of a + z σ is therefore found with probability Φ(z). The standard error may come from
draws of a posterior, or from the information of a design before any measurement.
"""

import numpy as np
import scipy
from scipy.special import logsumexp, ndtri

from bayesfric.analysis import Prior
from bayesfric.arrays import Array
from bayesfric.inference.priors import LOG_2PI, from_normal, log_density, prior_sd

NODES = np.linspace(-9.0, 9.0, 721)  # nodes around an estimate, in standard errors
LARGEST = 1e4  # amplitude that is found under any prior, in standard errors
LEAST_PRECISION_RATIO = (
    1.05  # least ratio of posterior to prior precision of an amplitude that data inform
)
LEAST_QUANTILE = -8.0  # normal quantile at which the sign of a prior is tested


def log_bayes_factor(estimate: float, error: float, prior: Prior) -> float:
    """Return the log Bayes factor for an effect whose amplitude has a given estimate [nat].

    Parameters
    ----------
    estimate, error : float
        Estimate of the amplitude and its standard error, by the data alone.
    prior : Prior
        Prior of the amplitude.
    """
    step = float(np.log(NODES[1] - NODES[0]))
    if prior_sd(prior) < error:  # nodes around the estimate would miss a narrow prior
        amplitude = from_normal(prior, NODES)
        gained = amplitude * (estimate - amplitude / 2) / error**2
        return float(logsumexp(gained - 0.5 * (NODES**2 + LOG_2PI))) + step
    amplitude = estimate + error * NODES
    with np.errstate(divide="ignore"):
        density = log_density(prior, amplitude) - 0.5 * (NODES**2 + LOG_2PI)
    return float(logsumexp(density) + step + 0.5 * ((estimate / error) ** 2 + LOG_2PI)) + float(
        np.log(error)
    )


def smallest_found(error: float, prior: Prior, threshold: float, probability: float) -> float:
    """Return the smallest positive amplitude that is found with a given probability.

    Parameters
    ----------
    error : float
        Standard error of the amplitude, by the data alone.
    prior : Prior
        Prior of the amplitude.
    threshold : float
        Least log Bayes factor of an effect that is found [nat].
    probability : float
        Probability of finding it.
    """

    def beyond(errors: float) -> float:
        return log_bayes_factor(errors * error, error, prior) - threshold

    most = 1.0
    while most < LARGEST and beyond(most) <= 0:
        most *= 2
    smallest = 0.0 if beyond(0.0) > 0 else float(scipy.optimize.brentq(beyond, 0.0, most))
    return error * max(smallest + float(ndtri(probability)), 0.0)


def smallest_told_apart(error: float, threshold: float, probability: float) -> float:
    """Return the smallest amplitude of an effect that data distinguish from another effect.

    The two effects have similar priors, and each is fitted to the data. If the first one acts with
    an amplitude of d standard errors (d > 1), the difference of their log evidences has the
    distribution N(d² / 2, d²).

    Parameters
    ----------
    error : float
        Standard error of the amplitude, estimated together with that of the other effect.
    threshold : float
        Least log odds for the first effect [nat].
    probability : float
        Probability that the log odds reach the threshold.
    """
    normal = float(ndtri(probability))
    return error * max(normal + float(np.sqrt(normal**2 + 2 * threshold)), 0.0)


def amplitude_error(draws: Array, prior: Prior) -> float | None:
    """Return the standard error of an amplitude by the data alone; None if they do not inform it.

    Parameters
    ----------
    draws : ndarray, shape (S,)
        Draws of its posterior.
    prior : Prior
        Prior of the amplitude: normal, or positive.

    Notes
    -----
    With a positive prior, the posterior is taken as a normal distribution truncated at zero. The
    ratio of its second moment to its squared mean, which is between 1 and 2, determines that
    normal distribution.
    """
    width = prior_sd(prior) ** 2
    spread = float(draws.var())
    if float(from_normal(prior, np.array(LEAST_QUANTILE))) >= 0:
        width = float(np.mean(from_normal(prior, ndtri((np.arange(2000) + 0.5) / 2000)) ** 2))
        spread = _uncut(float(draws.mean()), float((draws**2).mean()))
    precision = 1 / spread
    return (
        None
        if precision * width < LEAST_PRECISION_RATIO
        else float(1 / np.sqrt(precision - 1 / width))
    )


def _uncut(mean: float, square: float) -> float:
    """Return the variance of a normal distribution, from the moments of its truncation at zero.

    Parameters
    ----------
    mean, square : float
        First and second moment of the truncated distribution.
    """

    def ratio(place: float) -> float:
        first, second = _moments(place)
        return second / first**2 - square / mean**2

    low, high = -12.0, 12.0
    if ratio(low) <= 0:
        place = low
    elif ratio(high) >= 0:
        return square - mean**2
    else:
        place = float(scipy.optimize.brentq(ratio, low, high))
    return float(mean / _moments(place)[0]) ** 2


def _moments(place: float) -> tuple[float, float]:
    """Return the first two moments of N(place, 1) truncated at zero."""
    x = np.linspace(0.0, max(place, 0.0) + 9.0, 4001)
    log = -0.5 * (x - place) ** 2
    weight = np.exp(log - log.max())
    weight /= weight.sum()
    return float(weight @ x), float(weight @ x**2)

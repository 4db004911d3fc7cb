"""The smallest effect that data would have shown, from the error of its amplitude.

If data determine the amplitude A of an effect with the error σ, they give an estimate
Â ~ N(A, σ²). The Bayes factor for the effect follows from the estimate and the prior,

    B(Â) = ∫ N(Â; A, σ²) p(A) dA / N(Â; 0, σ²),

and rises with it. The effect is found if B reaches a threshold, at the estimate a. An
amplitude of a + z σ is found with the probability Φ(z). The error may come from draws of a
posterior, or from the information of a design before anything was measured.
"""

import numpy as np
import scipy
from scipy.special import logsumexp, ndtri

from bayesfric.analysis import Prior
from bayesfric.arrays import Array
from bayesfric.inference.priors import LOG_2PI, from_normal, log_density, prior_sd

NODES = np.linspace(-9.0, 9.0, 721)  # in errors around an estimate
LARGEST = 1e4  # errors: an effect that far out is found whatever the prior
LEAST_PRECISION_RATIO = (
    1.05  # least ratio of posterior to prior precision of an amplitude that data inform
)
LEAST_QUANTILE = -8.0  # where a prior that knows one sign ends


def log_bayes_factor(estimate: float, error: float, prior: Prior) -> float:
    """Return the log Bayes factor for an effect whose amplitude has this estimate [nat].

    Parameters
    ----------
    estimate, error : float
        Of the amplitude, by the data alone.
    prior : Prior
        Of the amplitude.
    """
    step = float(np.log(NODES[1] - NODES[0]))
    if prior_sd(prior) < error:  # far out nodes around an estimate pass it by
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
    """Return the smallest amplitude that is found with a probability.

    Parameters
    ----------
    error : float
        Of the amplitude, by the data alone.
    prior : Prior
        Of the amplitude; positive amplitudes are asked about.
    threshold : float
        Log Bayes factor from which on the effect is found [nat].
    probability : float
        Of finding it.
    """

    def beyond(errors: float) -> float:
        return log_bayes_factor(errors * error, error, prior) - threshold

    most = 1.0
    while most < LARGEST and beyond(most) <= 0:
        most *= 2
    smallest = 0.0 if beyond(0.0) > 0 else float(scipy.optimize.brentq(beyond, 0.0, most))
    return error * max(smallest + float(ndtri(probability)), 0.0)


def smallest_told_apart(error: float, threshold: float, probability: float) -> float:
    """Return the smallest amplitude at which data prefer an effect to another, or 0.

    Each of two effects of like priors takes what it can of the data. Where the first acts, their
    log evidences differ by N(d² / 2, d²), d being its amplitude in errors, where that is above 1.

    Parameters
    ----------
    error : float
        Of the amplitude, beside any amount of the other effect.
    threshold : float
        Log odds from which on the first is preferred [nat].
    probability : float
        Of that.
    """
    normal = float(ndtri(probability))
    return error * max(normal + float(np.sqrt(normal**2 + 2 * threshold)), 0.0)


def amplitude_error(draws: Array, prior: Prior) -> float | None:
    """Return the error of an amplitude by the data alone, or None where they do not inform it.

    Parameters
    ----------
    draws : ndarray, shape (S,)
        Of its posterior.
    prior : Prior
        Of the amplitude: normal, or one that knows its sign and is cut at zero.

    Notes
    -----
    A posterior that is a normal cut at zero has a ratio of its second moment to the square of
    its mean between 1 and 2, which gives the normal.
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
    """Return the variance of the normal whose part above zero has these two moments."""

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
    """Return the first two moments of N(place, 1) cut at zero."""
    x = np.linspace(0.0, max(place, 0.0) + 9.0, 4001)
    log = -0.5 * (x - place) ** 2
    weight = np.exp(log - log.max())
    weight /= weight.sum()
    return float(weight @ x), float(weight @ x**2)

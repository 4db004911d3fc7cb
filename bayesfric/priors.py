"""Normalised prior densities, and the scale on which a parameter is sampled.

A parameter that is positive by its prior is sampled as its logarithm, every
other one as itself; the log density on the sampling scale includes the Jacobian.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats

from bayesfric.analysis import HalfNormal, LogNormal, Normal, Prior, Uniform

__all__ = ["Parameter", "draw", "is_positive", "log_density", "prior_sd", "quantile"]

LOG_2PI = float(np.log(2 * np.pi))


@dataclass(frozen=True)
class Parameter:
    """A parameter with its name, unit and prior.

    Parameters
    ----------
    name : str
        Unique, as in ``c1[small]``.
    unit : str
        SI, angles in degrees; ``1`` for a ratio.
    prior : Prior
        Normalised density in that unit.
    """

    name: str
    unit: str
    prior: Prior

    @property
    def positive(self) -> bool:
        """Whether the parameter is sampled as its logarithm."""
        return is_positive(self.prior)


def is_positive(prior: Prior) -> bool:
    """Return whether a prior allows positive values only."""
    return isinstance(prior, HalfNormal | LogNormal) or (
        isinstance(prior, Uniform) and prior.low > 0
    )


def log_density(prior: Prior, value: ArrayLike) -> NDArray[np.float64]:
    """Return the log of a normalised prior density; −inf outside its support.

    Parameters
    ----------
    prior : Prior
        The density.
    value : array_like
        Where to evaluate it, in the parameter's unit.
    """
    x = np.asarray(value, dtype=np.float64)
    with np.errstate(divide="ignore", invalid="ignore"):
        match prior:
            case HalfNormal(scale=scale):
                density = np.log(2 / scale) - 0.5 * (LOG_2PI + (x / scale) ** 2)
                inside = x >= 0
            case LogNormal(median=median, sd_log=sd):
                density = -np.log(x * sd) - 0.5 * (LOG_2PI + (np.log(x / median) / sd) ** 2)
                inside = x > 0
            case Normal(mean=mean, sd=sd):
                density = -np.log(sd) - 0.5 * (LOG_2PI + ((x - mean) / sd) ** 2)
                inside = np.full(x.shape, True)
            case Uniform(low=low, high=high):
                density = np.full_like(x, -np.log(high - low))
                inside = (x >= low) & (x <= high)
    return np.where(inside, density, -np.inf)


def quantile(prior: Prior, probability: ArrayLike) -> NDArray[np.float64]:
    """Return quantiles of a prior.

    Parameters
    ----------
    prior : Prior
        The density.
    probability : array_like
        Between 0 and 1.
    """
    return np.asarray(
        _frozen(prior).ppf(np.asarray(probability, dtype=np.float64)), dtype=np.float64
    )


def prior_sd(prior: Prior) -> float:
    """Return the standard deviation of a prior."""
    return float(_frozen(prior).std())


def draw(prior: Prior, size: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return independent draws of a prior, shape (size,)."""
    return quantile(prior, rng.uniform(size=size))


def _frozen(prior: Prior) -> Any:
    match prior:
        case HalfNormal(scale=scale):
            return stats.halfnorm(scale=scale)
        case LogNormal(median=median, sd_log=sd):
            return stats.lognorm(s=sd, scale=median)
        case Normal(mean=mean, sd=sd):
            return stats.norm(mean, sd)
        case Uniform(low=low, high=high):
            return stats.uniform(low, high - low)

"""Normalised prior densities, and the scale on which a parameter is sampled.

A parameter is sampled as a number z. The standard normal probability below z is the prior
probability below the parameter. On this scale every prior is N(0, 1), bounds are at infinity, and
a standard deviation near 0 has no long tail.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray
from scipy import special

from bayesfric.arrays import Array
from bayesfric.families import (
    Beta,
    Gamma,
    HalfCauchy,
    HalfNormal,
    LogNormal,
    Normal,
    Prior,
    StudentT,
    TruncatedNormal,
    Uniform,
)
from bayesfric.inference.quadratic import LOG_2PI as LOG_2PI

LOG_2 = float(np.log(2))
QUANTILES = 1000  # quantiles over which the density of a share's product is averaged
FARTHEST_Z = 30.0  # standard deviations beyond which logarithms of tail probabilities are used

CLOSED_FORMS = (HalfNormal, LogNormal, Normal, Uniform)

Kind = Literal["coefficient", "scatter", "noise", "other"]


@dataclass(frozen=True)
class Parameter:
    """A parameter with its name, unit and prior.

    Parameters
    ----------
    name : str
        Unique name, such as ``c1[small]``.
    unit : str
        SI unit, with angles in degrees; ``1`` for a ratio.
    prior : Prior
        Normalised density in that unit.
    kind : {"coefficient", "scatter", "noise", "other"}
        Group of the parameter in results.
    power : float or None
        Power of the parameter in which its posterior is nearly normal: 1 if the data are linear
        in it, 1/2 for a standard deviation that may be 0. None means the sampling scale z.
    share_of : Parameter or None
        A positive parameter with power 1. `prior` is then the density of the ratio of this
        parameter to that one, and the ratio is independent of it.
    """

    name: str
    unit: str
    prior: Prior
    kind: Kind = "other"
    power: float | None = None
    share_of: "Parameter | None" = None

    def sd(self) -> float:
        """Return the standard deviation of its marginal prior; infinite if it has none."""
        if self.share_of is None:
            return prior_sd(self.prior)
        priors = (self.prior, self.share_of.prior)
        if not all(np.isfinite(prior_sd(prior)) for prior in priors):
            return np.inf
        square = np.prod([_frozen(prior).moment(2) for prior in priors])
        mean = np.prod([_frozen(prior).mean() for prior in priors])
        return float(np.sqrt(square - mean**2))

    def width(self) -> float:
        """Return that standard deviation; if it has none, about half its 68 % interval."""
        sd = self.sd()
        if np.isfinite(sd):
            return sd
        middle = 1.0 if self.share_of is None else float(quantile(self.share_of.prior, 0.5))
        return middle * prior_width(self.prior)

    def density(self, value: ArrayLike) -> NDArray[np.float64]:
        """Return its marginal prior density.

        That of a parameter with `share_of` is averaged over quantiles of the other parameter.

        Parameters
        ----------
        value : array_like
            In the parameter's unit.
        """
        x = np.asarray(value, dtype=np.float64)
        if self.share_of is None:
            return np.exp(log_density(self.prior, x))
        whole = quantile(self.share_of.prior, (np.arange(QUANTILES) + 0.5) / QUANTILES)
        densities = np.exp(log_density(self.prior, x[..., None] / whole)) / whole
        return np.asarray(densities.mean(axis=-1))

    def described(self) -> str:
        """Return its prior in words, as in ``normal(mean=0, sd=0.005) of c1[small]``."""
        whole = "" if self.share_of is None else f" of {self.share_of.name}"
        return describe(self.prior) + whole


def joined(priors: Sequence[Prior]) -> list[tuple[list[int], Prior]]:
    """Combine priors of the same family, so that they are evaluated in one call.

    Parameters
    ----------
    priors : sequence of Prior
        The prior of each parameter.

    Returns
    -------
    list of (list of int, Prior)
        Indices in `priors`, and a prior whose constants are arrays over these indices.
        :func:`log_density`, :func:`from_normal` and :func:`to_normal` take it with values whose
        last axis has these indices. Priors without a closed form are not combined.
    """
    together: dict[object, list[int]] = {}
    for place, prior in enumerate(priors):
        key = type(prior) if isinstance(prior, CLOSED_FORMS) else place
        together.setdefault(key, []).append(place)
    return [(places, _stacked([priors[k] for k in places])) for places in together.values()]


def _stacked(priors: Sequence[Prior]) -> Prior:
    if len(priors) == 1:
        return priors[0]
    family = type(priors[0])
    numbers: dict[str, Any] = {
        name: np.array([getattr(prior, name) for prior in priors])
        for name in family.model_fields
        if name != "family"
    }
    return family.model_construct(**numbers)  # arrays, which validation would refuse


def log_density(prior: Prior, value: ArrayLike) -> NDArray[np.float64]:
    """Return the log of a normalised prior density; −inf outside its support.

    Parameters
    ----------
    prior : Prior
        The density.
    value : array_like
        Values in the parameter's unit.
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
                density = -np.log(high - low) + np.zeros_like(x)
                inside = (x >= low) & (x <= high)
            case _:
                return np.asarray(_frozen(prior).logpdf(x), dtype=np.float64)
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


def from_normal(prior: Prior, z: ArrayLike) -> NDArray[np.float64]:
    """Return the parameter at which the prior has the probability of a standard normal below z.

    Parameters
    ----------
    prior : Prior
        The density.
    z : array_like
        Values on the sampling scale.
    """
    z = np.asarray(z, dtype=np.float64)
    match prior:
        case HalfNormal(scale=scale):
            # Each form is inexact in the tail of the other.
            low = np.sqrt(2) * special.erfinv(special.ndtr(np.minimum(z, 0.0)))
            high = -special.ndtri(special.ndtr(-np.clip(z, 0.0, FARTHEST_Z)) / 2)
            value = np.where(z < 0, low, high)
            if (z > FARTHEST_Z).any():
                beyond = -special.ndtri_exp(special.log_ndtr(-np.maximum(z, FARTHEST_Z)) - LOG_2)
                value = np.where(z > FARTHEST_Z, beyond, value)
            return np.asarray(scale * value)
        case LogNormal(median=median, sd_log=sd):
            return np.asarray(median * np.exp(sd * z))
        case Normal(mean=mean, sd=sd):
            return np.asarray(mean + sd * z)
        case Uniform(low=lowest, high=highest):
            return np.asarray(lowest + (highest - lowest) * special.ndtr(z))
        case TruncatedNormal(mean=mean, sd=sd):  # SciPy's function takes fifty times as long
            sign, first, last = _between(prior)
            u = sign * z
            tail = special.ndtr(-np.abs(u)) * (last - first)
            inside = np.where(u < 0, first + tail, last - tail)
            return np.asarray(mean + sign * sd * special.ndtri(inside))
        case _:
            # Upper tails use their own probability, since 1 minus a small number loses digits.
            tail, density = special.ndtr(-np.abs(z)), _frozen(prior)
            return np.asarray(np.where(z < 0, density.ppf(tail), density.isf(tail)))


def to_normal(prior: Prior, value: ArrayLike) -> NDArray[np.float64]:
    """Return the value of a parameter on the sampling scale, the inverse of :func:`from_normal`.

    Parameters
    ----------
    prior : Prior
        The density.
    value : array_like
        Values in the parameter's unit. At and beyond the prior's bounds the result is ±inf.
    """
    x = np.asarray(value, dtype=np.float64)
    match prior:
        case HalfNormal(scale=scale):
            u = np.maximum(x, 0.0) / scale
            low = special.ndtri(special.erf(u / np.sqrt(2)))
            high = -special.ndtri(2 * special.ndtr(-np.minimum(u, FARTHEST_Z)))
            beyond = -special.ndtri_exp(special.log_ndtr(-np.maximum(u, FARTHEST_Z)) + LOG_2)
            return np.asarray(np.where(u < 0.67, low, np.where(u > FARTHEST_Z, beyond, high)))
        case LogNormal(median=median, sd_log=sd):
            with np.errstate(divide="ignore"):
                return np.asarray(np.log(np.maximum(x, 0.0) / median) / sd)
        case Normal(mean=mean, sd=sd):
            return np.asarray((x - mean) / sd)
        case Uniform(low=lowest, high=highest):
            return np.asarray(special.ndtri(np.clip((x - lowest) / (highest - lowest), 0.0, 1.0)))
        case TruncatedNormal(mean=mean, sd=sd):
            sign, first, last = _between(prior)
            inside = np.clip(special.ndtr(sign * (x - mean) / sd), first, last)
            below, above = (inside - first) / (last - first), (last - inside) / (last - first)
            return sign * _nearer_tail(below, above)
        case _:
            return _nearer_tail(_frozen(prior).cdf(x), _frozen(prior).sf(x))


def _nearer_tail(below: Array, above: Array) -> Array:
    """Return normal quantiles, from the smaller of the probabilities below and above."""
    return np.asarray(np.where(below < above, special.ndtri(below), -special.ndtri(above)))


def _between(prior: TruncatedNormal) -> tuple[int, float, float]:
    """Return a sign, and normal probabilities of the bounds.

    If both bounds are above the mean, the sign is −1 and the bounds are mirrored at the mean, so
    that both probabilities keep their digits.
    """
    low = (prior.lowest - prior.mean) / prior.sd
    high = np.inf if prior.high is None else (prior.high - prior.mean) / prior.sd
    sign = -1 if low > 0 else 1
    ends = (low, high) if sign > 0 else (-high, -low)
    return sign, float(special.ndtr(ends[0])), float(special.ndtr(ends[1]))


def prior_sd(prior: Prior) -> float:
    """Return the standard deviation of a prior; infinite if it has none."""
    sd = float(_frozen(prior).std())
    return sd if np.isfinite(sd) else np.inf


def prior_width(prior: Prior) -> float:
    """Return the standard deviation of a prior; if it has none, half its 68 % interval."""
    sd = prior_sd(prior)
    low, high = from_normal(prior, [-1.0, 1.0])
    return sd if np.isfinite(sd) else float(high - low) / 2


def draw(prior: Prior, size: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return independent draws of a prior, shape (size,)."""
    return quantile(prior, rng.uniform(size=size))


@cache
def _frozen(prior: Prior) -> Any:
    match prior:
        case HalfNormal(scale=scale):
            return scipy.stats.halfnorm(scale=scale)
        case LogNormal(median=median, sd_log=sd):
            return scipy.stats.lognorm(s=sd, scale=median)
        case Normal(mean=mean, sd=sd):
            return scipy.stats.norm(mean, sd)
        case Uniform(low=low, high=high):
            return scipy.stats.uniform(low, high - low)
        case StudentT(degrees_of_freedom=freedom, location=location, scale=scale):
            return scipy.stats.t(freedom, location, scale)
        case HalfCauchy(scale=scale):
            return scipy.stats.halfcauchy(scale=scale)
        case Gamma(shape=shape, scale=scale):
            return scipy.stats.gamma(shape, scale=scale)
        case Beta(a=a, b=b, high=high):
            return scipy.stats.beta(a, b, scale=high)
        case TruncatedNormal(mean=mean, sd=sd, low=lowest, high=highest):
            ends = (-np.inf if lowest is None else lowest, np.inf if highest is None else highest)
            return scipy.stats.truncnorm(*((end - mean) / sd for end in ends), mean, sd)


def describe(prior: Prior) -> str:
    """Return a prior in words, as in ``half-normal(scale=0.05)``."""
    numbers = prior.model_dump(exclude={"family"}, exclude_none=True)
    return f"{prior.family}({', '.join(f'{key}={value:g}' for key, value in numbers.items())})"

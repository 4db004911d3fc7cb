"""Families of densities by which a user states what is known beforehand.

The models validate and document; :mod:`bayesfric.inference.priors` computes.
"""

import math
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field, model_validator

from bayesfric.docstrings import Documented

FARTHEST = 8.0  # standard deviations: a normal cut beyond is not the density that is meant


def _number(value: Any) -> Any:
    if isinstance(value, bool | str):
        raise ValueError("a number, and no text or truth value")
    return value


Positive = Annotated[float, Field(gt=0, allow_inf_nan=False), BeforeValidator(_number)]
Finite = Annotated[float, Field(allow_inf_nan=False), BeforeValidator(_number)]


class Section(Documented):
    """A table of a TOML file: unknown keys are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Family(Section):
    """A density whose numbers may be given in their order, as in ``HalfNormal(0.05)``."""

    width: ClassVar[str | None] = None
    """Name of the number that makes the density wider around the same centre."""
    pure: ClassVar[frozenset[str]] = frozenset({"family"})
    """Names of what has no unit."""

    def __init__(self, *numbers: float, **named: Any) -> None:
        names = [name for name in type(self).model_fields if name != "family"]
        if len(numbers) > len(names):
            raise TypeError(f"{type(self).__name__} takes {len(names)} numbers: {names}")
        super().__init__(**dict(zip(names, numbers, strict=False)), **named)

    @property
    def lowest(self) -> float:
        """Where the support begins."""
        return 0.0

    def times(self, factor: float) -> Self:
        """Return the density of a number that is larger by a factor above zero."""
        numbers = {name: getattr(self, name) for name in set(type(self).model_fields) - self.pure}
        scaled = {name: factor * value for name, value in numbers.items() if value is not None}
        return self.model_copy(update=scaled)

    def widened(self, factor: float) -> Self:
        """Return the density, wider by a factor; a density between bounds stays as it is."""
        if self.width is None:
            return self
        return self.model_copy(update={self.width: factor * getattr(self, self.width)})


class HalfNormal(Family):
    """Half-normal: values above zero, most of them below `scale`.

    Fields
    ------
    scale: Standard deviation of the normal that is folded at 0.
    """

    width = "scale"
    family: Literal["half-normal"] = "half-normal"
    scale: Positive


class LogNormal(Family):
    """Log-normal: values above zero around `median`.

    Fields
    ------
    median: Median, in the parameter's unit.
    sd_log: Standard deviation of the natural logarithm.
    """

    width = "sd_log"
    pure = frozenset({"family", "sd_log"})
    family: Literal["log-normal"] = "log-normal"
    median: Positive
    sd_log: Positive


class Normal(Family):
    """Normal: any sign.

    Fields
    ------
    mean: Mean, in the parameter's unit.
    sd: Standard deviation, in the parameter's unit.
    """

    width = "sd"
    family: Literal["normal"] = "normal"
    mean: Finite
    sd: Positive

    @property
    def lowest(self) -> float:
        """Where the support begins."""
        return -math.inf


class StudentT(Family):
    """Student-t: any sign, with tails heavier than a normal's.

    Fields
    ------
    degrees_of_freedom: Of the tails; 1 is a Cauchy density.
    location: Median, in the parameter's unit.
    scale: Scale, in the parameter's unit.
    """

    width = "scale"
    pure = frozenset({"family", "degrees_of_freedom"})
    family: Literal["student-t"] = "student-t"
    degrees_of_freedom: Positive
    location: Finite
    scale: Positive

    @property
    def lowest(self) -> float:
        """Where the support begins."""
        return -math.inf


class HalfCauchy(Family):
    """Half-Cauchy: values above zero, half of them below `scale`, without mean or variance.

    Fields
    ------
    scale: Median, in the parameter's unit.
    """

    width = "scale"
    family: Literal["half-cauchy"] = "half-cauchy"
    scale: Positive


class Gamma(Family):
    """Gamma: values above zero, around `shape` times `scale`.

    Fields
    ------
    shape: Shape; 1 is an exponential density.
    scale: Scale, one over the rate, in the parameter's unit.
    """

    pure = frozenset({"family", "shape"})
    family: Literal["gamma"] = "gamma"
    shape: Positive
    scale: Positive


class Beta(Family):
    """Beta: values between 0 and `high`.

    Fields
    ------
    a: Shape at 0.
    b: Shape at the upper bound.
    high: Upper bound, in the parameter's unit.
    """

    pure = frozenset({"family", "a", "b"})
    family: Literal["beta"] = "beta"
    a: Positive
    b: Positive
    high: Positive = 1.0


class Uniform(Family):
    """Uniform between two bounds.

    Fields
    ------
    low: Lower bound, in the parameter's unit.
    high: Upper bound, above `low`.
    """

    family: Literal["uniform"] = "uniform"
    low: Finite
    high: Finite

    @property
    def lowest(self) -> float:
        """Where the support begins."""
        return self.low

    @model_validator(mode="after")
    def _ordered(self) -> "Uniform":
        if self.high <= self.low:
            raise ValueError("a high above low")
        return self


class TruncatedNormal(Family):
    """Normal that is cut at one bound, or at two.

    Fields
    ------
    mean: Of the normal before it is cut, in the parameter's unit.
    sd: Of the normal before it is cut, in the parameter's unit.
    low: Lower bound; absent: none.
    high: Upper bound, above `low`; absent: none.
    """

    width = "sd"
    family: Literal["truncated-normal"] = "truncated-normal"
    mean: Finite
    sd: Positive
    low: Finite | None = None
    high: Finite | None = None

    @property
    def lowest(self) -> float:
        """Where the support begins."""
        return -math.inf if self.low is None else self.low

    @model_validator(mode="after")
    def _ordered(self) -> "TruncatedNormal":
        low, high = self.lowest, math.inf if self.high is None else self.high
        if self.low is None and self.high is None:
            raise ValueError("a low, a high, or both")
        if high <= low:
            raise ValueError("a high above low")
        if not (low - FARTHEST * self.sd <= self.mean <= high + FARTHEST * self.sd):
            raise ValueError(f"bounds that leave what is within {FARTHEST:g} sd of the mean")
        return self


Prior = Annotated[
    HalfNormal
    | LogNormal
    | Normal
    | Uniform
    | StudentT
    | HalfCauchy
    | Gamma
    | Beta
    | TruncatedNormal,
    Field(discriminator="family"),
]


def _above_zero(prior: Prior) -> Prior:
    if prior.lowest < 0:
        raise ValueError(f"a density of values above zero; {prior.family} has some below")
    return prior


PriorAboveZero = Annotated[Prior, AfterValidator(_above_zero)]

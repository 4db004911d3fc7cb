"""Families of densities by which a user states what is known beforehand.

The models validate and document; :mod:`bayesfric.inference.priors` computes.
"""

import math
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, model_validator

FARTHEST = 8.0  # standard deviations: a normal cut beyond is not the density that is meant


def _number(value: Any) -> Any:
    if isinstance(value, bool | str):
        raise ValueError("a number, and no text or truth value")
    return value


Positive = Annotated[float, Field(gt=0, allow_inf_nan=False), BeforeValidator(_number)]
Finite = Annotated[float, Field(allow_inf_nan=False), BeforeValidator(_number)]


class Section(BaseModel):
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
    """Half-normal: values above zero, most of them below `scale`."""

    width = "scale"
    family: Literal["half-normal"] = "half-normal"
    scale: Positive = Field(description="Standard deviation of the normal that is folded at 0.")


class LogNormal(Family):
    """Log-normal: values above zero around `median`."""

    width = "sd_log"
    pure = frozenset({"family", "sd_log"})
    family: Literal["log-normal"] = "log-normal"
    median: Positive = Field(description="Median, in the parameter's unit.")
    sd_log: Positive = Field(description="Standard deviation of the natural logarithm.")


class Normal(Family):
    """Normal: any sign."""

    width = "sd"
    family: Literal["normal"] = "normal"
    mean: Finite = Field(description="Mean, in the parameter's unit.")
    sd: Positive = Field(description="Standard deviation, in the parameter's unit.")

    @property
    def lowest(self) -> float:
        """Where the support begins."""
        return -math.inf


class StudentT(Family):
    """Student-t: any sign, with tails heavier than a normal's."""

    width = "scale"
    pure = frozenset({"family", "degrees_of_freedom"})
    family: Literal["student-t"] = "student-t"
    degrees_of_freedom: Positive = Field(description="Of the tails; 1 is a Cauchy density.")
    location: Finite = Field(description="Median, in the parameter's unit.")
    scale: Positive = Field(description="Scale, in the parameter's unit.")

    @property
    def lowest(self) -> float:
        """Where the support begins."""
        return -math.inf


class HalfCauchy(Family):
    """Half-Cauchy: values above zero, half of them below `scale`, without mean or variance."""

    width = "scale"
    family: Literal["half-cauchy"] = "half-cauchy"
    scale: Positive = Field(description="Median, in the parameter's unit.")


class Gamma(Family):
    """Gamma: values above zero, around `shape` times `scale`."""

    pure = frozenset({"family", "shape"})
    family: Literal["gamma"] = "gamma"
    shape: Positive = Field(description="Shape; 1 is an exponential density.")
    scale: Positive = Field(description="Scale, one over the rate, in the parameter's unit.")


class Beta(Family):
    """Beta: values between 0 and `high`."""

    pure = frozenset({"family", "a", "b"})
    family: Literal["beta"] = "beta"
    a: Positive = Field(description="Shape at 0.")
    b: Positive = Field(description="Shape at the upper bound.")
    high: Positive = Field(1.0, description="Upper bound, in the parameter's unit.")


class Uniform(Family):
    """Uniform between two bounds."""

    family: Literal["uniform"] = "uniform"
    low: Finite = Field(description="Lower bound, in the parameter's unit.")
    high: Finite = Field(description="Upper bound, above `low`.")

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
    """Normal that is cut at one bound, or at two."""

    width = "sd"
    family: Literal["truncated-normal"] = "truncated-normal"
    mean: Finite = Field(description="Of the normal before it is cut, in the parameter's unit.")
    sd: Positive = Field(description="Of the normal before it is cut, in the parameter's unit.")
    low: Finite | None = Field(None, description="Lower bound; absent: none.")
    high: Finite | None = Field(None, description="Upper bound, above `low`; absent: none.")

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

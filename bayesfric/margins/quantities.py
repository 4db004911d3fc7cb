"""A number of a loop file that may be uncertain: a plain number or a distribution.

In TOML, ``inertia_kg_m2 = 0.3`` or
``inertia_kg_m2 = { family = "log-normal", median = 0.3, sd_log = 0.2 }``.
"""

from typing import Annotated, Any

from pydantic import AfterValidator, Discriminator, Tag

from bayesfric.analysis import HalfNormal, LogNormal, Normal, Uniform
from bayesfric.inference.priors import from_normal

FAMILIES = {"number", "half-normal", "log-normal", "normal", "uniform"}
"""Kinds of a quantity; pydantic also puts these tags into the place of an error."""
WIDEST_NORMAL = 5.0  # least mean of a normal, in its sd: no negative draw in a million


def _family(value: Any) -> str:
    if isinstance(value, dict):
        return str(value.get("family"))
    return getattr(value, "family", "number")


def _finite(value: Any) -> Any:
    if isinstance(value, bool) or (isinstance(value, float) and not abs(value) < float("inf")):
        raise ValueError("a finite number")
    return value


Quantity = Annotated[
    Annotated[float, AfterValidator(_finite), Tag("number")]
    | Annotated[HalfNormal, Tag("half-normal")]
    | Annotated[LogNormal, Tag("log-normal")]
    | Annotated[Normal, Tag("normal")]
    | Annotated[Uniform, Tag("uniform")],
    Discriminator(
        _family,
        custom_error_type="quantity",
        custom_error_message="a number, or a table with the family half-normal, log-normal, "
        "normal or uniform",
    ),
]
"""A number or a distribution, of any sign."""


def _at_least_zero(value: Any) -> Any:
    match value:
        case Normal(mean=mean, sd=sd) if mean < WIDEST_NORMAL * sd:
            raise ValueError(
                f"a normal that stays above 0, its mean over {WIDEST_NORMAL:g} sd; or a log-normal"
            )
        case Uniform(low=low) if low < 0:
            raise ValueError("a uniform without negative values")
        case float() if value < 0:
            raise ValueError("a number of at least 0")
    return value


def _above_zero(value: Any) -> Any:
    match value:
        case HalfNormal() | Uniform(low=0.0):
            raise ValueError("a distribution that stays above 0, such as a log-normal")
        case float() if value <= 0:
            raise ValueError("a number above 0")
    return _at_least_zero(value)


NonNegative = Annotated[Quantity, AfterValidator(_at_least_zero)]
"""A number or a distribution without negative values."""
Positive = Annotated[Quantity, AfterValidator(_above_zero)]
"""A number or a distribution above zero."""


def is_uncertain(value: object) -> bool:
    """Return whether a value of a loop file is a distribution."""
    return isinstance(value, HalfNormal | LogNormal | Normal | Uniform)


def central(value: float | HalfNormal | LogNormal | Normal | Uniform) -> float:
    """Return the number, or the median of the distribution."""
    return float(value) if isinstance(value, float | int) else float(from_normal(value, 0.0))

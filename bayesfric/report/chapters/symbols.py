"""How parameters are written: symbol, power of ten and unit, and an estimate in cells."""

from bayesfric.plots.labels import SYMBOLS, parts
from bayesfric.report.content import Math
from bayesfric.report.quantities import error_cells, format_number, format_unit, interval_cells
from bayesfric.schemas.base import Interval

EXPONENTS = {
    "c1": -3,
    "c2": -3,
    "c3": -6,
    "tau": -2,
    "omega": -2,
    "omega_intercept": -2,
    "wander": -2,
    "sigma_x": -6,
    "sigma_t": -6,
    "sigma_current": -3,
    "load_noise": -3,
}
"""Powers of ten in which tables print a parameter."""


def symbol(name: str) -> tuple[Math | str, ...]:
    """Return a parameter as text, ``c1[small]`` as c₁ small."""
    stem, whose = parts(name)
    written: Math | str = Math(SYMBOLS[stem]) if stem in SYMBOLS else stem.replace("_", " ")
    return (written, f" {whose}") if whose else (written,)


def unit_head(name: str, unit: str) -> str:
    """Return the unit of a cell of this parameter, with its power of ten."""
    return format_unit(unit, exponent(name))


def exponent(name: str) -> int:
    """Return the power of ten in which tables print a parameter."""
    return EXPONENTS.get(parts(name)[0], 0)


def coefficient_cells(size: str, name: str, unit: str) -> tuple[str, tuple[Math | str, ...]]:
    """Return the first cells of a row: a pulley size, and its coefficient with its unit."""
    return size, (*symbol(name), f" [{unit_head(name, unit)}]")


def scaled(value: float | None, exponent: int, digits: int = 3) -> str:
    """Return a number divided by the power of ten that stands beside it; a dash for None."""
    return format_number(value, digits, None, exponent).split(" ")[0]


def estimate_cells(estimate: Interval, exponent: int) -> tuple[str, str, str, str]:
    """Return mean, sd, 5 % and 95 % quantile, divided by a power of ten."""
    mean, low, high = interval_cells(estimate.mean, estimate.q05, estimate.q95, exponent)
    return mean, scaled(estimate.sd, exponent, digits=2), low, high


def half_width(number: Interval) -> float:
    """Return half of the 90 % interval."""
    return (number.q95 - number.q05) / 2


def plus_minus(number: Interval, exponent: int = 0, *, of_mean: bool = False) -> str:
    """Write a median or mean ± half of the 90 % interval, divided by a power of ten."""
    scale, middle = 10.0**-exponent, number.mean if of_mean else number.q50
    return " ± ".join(error_cells(scale * middle, scale * half_width(number)))

"""How parameters are written: symbol, power of ten and unit."""

from bayesfric.plots.labels import SYMBOLS, parts
from bayesfric.report.content import Math
from bayesfric.report.quantities import format_unit

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

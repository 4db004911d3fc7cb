"""How probabilities are added and written, in sentences and in tables alike.

Sums of floating-point probabilities miss 1 by rounding. They are made probabilities here and
nowhere else, so that no reader meets 1.0000000000000002.
"""

import math
from collections.abc import Hashable, Iterable, Mapping
from typing import TypeVar

Event = TypeVar("Event", bound=Hashable)

ROUNDING = 1e-9  # by which a sum of probabilities may miss what it should be

LN10 = math.log(10)
ALL_BUT, PAST_ALL = 0.999, 1.0005
"""A share whose 90 % interval lies between these is written as a bound, more than 99.9 %."""
WIDE = 0.095  # width of the interval of a share from which it is written in whole per cent
LEAST_PLAIN = 0.1  # of a number that is written without a power of ten
LEAST_STATED = 0.001  # below it, and as close to 1, a probability is stated as a bound


def normalised(weights: Mapping[Event, float]) -> dict[Event, float]:
    """Return probabilities that are proportional to weights and add up to 1.

    Parameters
    ----------
    weights : mapping to float
        Of events that exclude one another, at least one above 0; one that rounding took below
        0 counts as 0.

    Raises
    ------
    ValueError
        A weight is not finite, or clearly below 0, or none is above 0.
    """
    largest = max(weights.values(), default=0.0)
    if not all(math.isfinite(w) and w >= -ROUNDING * largest for w in weights.values()):
        raise ValueError(f"expected weights of 0 or more, got {dict(weights)!r}")
    kept = {name: max(float(weight), 0.0) for name, weight in weights.items()}
    whole = math.fsum(kept.values())
    if whole <= 0:
        raise ValueError("expected a weight above 0")
    return {name: min(weight / whole, 1.0) for name, weight in kept.items()}


def total(probabilities: Iterable[float]) -> float:
    """Return the sum of probabilities of events that exclude one another.

    Raises
    ------
    ValueError
        The sum is outside of 0 to 1 by more than rounding.
    """
    whole = math.fsum(probabilities)
    if not -ROUNDING <= whole <= 1 + ROUNDING:
        raise ValueError(f"expected probabilities that add up to 1 at most, got {whole!r}")
    return min(max(whole, 0.0), 1.0)


def stated(p: float, least: float = LEAST_STATED) -> str:
    """Write a probability with a third decimal near either end: 0.93, 0.004, > 0.999.

    Nothing that is computed from finitely many draws, or by approximation, is certain: neither 0
    nor 1 is ever written.

    Parameters
    ----------
    p : float
        The probability.
    least : float
        What it is stated to be below, or above as far from 1, where it is nearer than that.

    Raises
    ------
    ValueError
        If it is not within 0 to 1.
    """
    if not 0 <= p <= 1:
        raise ValueError(f"expected a probability, got {p!r}")
    if p < least:
        return f"< {least:.2g}"
    if p > 1 - least:
        return f"> {1 - least:.3g}"
    return f"{p:.{2 if 0.1 <= p <= 0.95 else 3}f}"


def stated_of_draws(p: float, draws: float) -> str:
    """Write a share of draws: where none or all of them have something, the bound at 95 %.

    Parameters
    ----------
    p : float
        The share.
    draws : float
        How many there are.
    """
    return stated(p, max(LEAST_STATED, bound_of(draws)) if p in (0, 1) else LEAST_STATED)


def bound_of(draws: float) -> float:
    """Return the probability below which, at 95 %, something is that none of the draws had."""
    return float(1 - 0.05 ** (1 / draws))


def bound_of_hits(hits: int, draws: int) -> float:
    """Return the probability below which, at 95 %, something is that some of the draws had.

    Clopper and Pearson's bound; with no hits it is :func:`bound_of`.
    """
    if hits >= draws:
        return 1.0
    from scipy.special import betaincinv  # which many commands never load

    return float(betaincinv(hits + 1, draws - hits, 0.95))


def percent(share: float) -> str:
    """Write a share in percent with three digits: 5 %, 0.1 %, never 0 % for one that is not."""
    return f"{100 * share:.3g} %"


def three_digits(value: float) -> str:
    """Return a number to three significant digits, zeros at its end among them: 0.00240."""
    return f"{value:#.3g}".removesuffix(".")


def in_thousands(value: float) -> str:
    """Return a number to three digits; one below a tenth times a power of a thousand: 4.16e-3.

    Tables of coefficients have such powers in their heads.
    """
    if value == 0 or abs(value) >= LEAST_PLAIN:
        return three_digits(value)
    power = 3 * math.floor(math.log10(abs(float(f"{value:.2e}"))) / 3)
    return f"{three_digits(value / 10.0**power)}e{power:+d}"


def two_digits(value: float) -> str:
    """Return a number to two significant digits, without a power of ten."""
    return f"{float(f'{value:.2g}'):g}"

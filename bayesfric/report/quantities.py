"""Numbers and units as people print them: the digits that the uncertainty allows.

A minus is a true minus (−), a unit follows a thin no-break space, and powers of
ten are written out (2.79 × 10⁻⁵). A number that does not exist is ``None`` in the
stored results, and a dash here.
"""

import math
import re
from decimal import Decimal

from bayesfric.probabilities import stated
from bayesfric.report.words import RAISED

MISSING = "—"
THIN = "\u202f"
MOST_DIGITS = 6  # significant ones of a number whose error is smaller than what anyone needs
CERTAIN = 6.0  # log10 of the odds beyond which their size says no more
FAR_SHIFT = 10.0  # standard deviations, likewise
_DECIMAL = re.compile(r"\d+\.\d+(e-?\d+)?")
_UNITS = {"": "", "-": "", "–": "", "1": "", "deg": "°", "1/deg": "deg⁻¹", "1/s": "s⁻¹"}


def format_unit(unit: str | None, exponent: int = 0) -> str:
    """Write a unit as printed: ``m/s^2`` as m/s², ``1/deg`` as deg⁻¹, ``-`` as nothing.

    With an exponent, as the head of a column whose cells leave it out: 10⁻⁵ deg⁻¹.
    """
    unit = unit or ""
    if exponent:
        power = "10" + str(exponent).translate(RAISED)
        return f"{power}{THIN}{format_unit(unit)}".rstrip(THIN)
    if unit in _UNITS:
        return _UNITS[unit]
    unit = re.sub(r"\^(-?\d+)", lambda match: match[1].translate(RAISED), unit)
    return unit.replace("*", "·")


def format_number(
    value: float | None, digits: int = 3, unit: str | None = None, exponent: int | None = None
) -> str:
    """Write one number with so many significant digits.

    Parameters
    ----------
    value : float or None
    digits : int
        Significant digits, one at least.
    unit : str, optional
        As stored, say ``m/s^2``.
    exponent : int, optional
        The power of ten to write it with; by default, none for numbers from 0.001
        to under a million, else its own.

    Returns
    -------
    str
        For example ``2.79 × 10⁻⁵ deg⁻¹``, or a dash for None.

    Raises
    ------
    ValueError
        If the value is not finite, or digits is under one.
    """
    if digits < 1:
        raise ValueError(f"expected one significant digit at least, got {digits}")
    if value is None:
        return MISSING
    _check_finite(value)
    # Round first: 0.0009996 is 0.00100 to three digits.
    value = float(f"{value:.{digits - 1}e}")
    power = _power(abs(value)) if exponent is None else exponent
    decimals = digits - 1 - _order(value) + power if value else digits - 1
    return _fixed(value, power, decimals) + _times(power) + _spaced(unit)


def format_interval(
    mean: float | None,
    q05: float | None,
    q95: float | None,
    unit: str | None = None,
) -> str:
    """Write a mean with its 90 % interval, to two digits of the interval's width.

    Parameters
    ----------
    mean, q05, q95 : float or None
        Mean, 5 % and 95 % quantile.
    unit : str, optional
        As stored.

    Returns
    -------
    str
        For example ``0.0128 [0.0121, 0.0135] N``, or a dash if one of the three is None.

    Raises
    ------
    ValueError
        If a number is not finite, or the quantiles are out of order.
    """
    if mean is None or q05 is None or q95 is None:
        return MISSING
    power = _power(max(abs(mean), abs(q05), abs(q95)))
    middle, low, high = interval_cells(mean, q05, q95, exponent=power)
    return f"{middle} [{low}, {high}]{_times(power)}{_spaced(unit)}"


def interval_cells(
    mean: float | None, q05: float | None, q95: float | None, exponent: int = 0
) -> tuple[str, str, str]:
    """Write a mean and its 90 % interval as three cells of a table.

    Parameters
    ----------
    mean, q05, q95 : float or None
        Mean, 5 % and 95 % quantile.
    exponent : int
        The power of ten that the head of the column states, see `format_unit`: the
        cells hold the numbers divided by it.

    Returns
    -------
    tuple of str
        With equal decimals; dashes for what is None.

    Raises
    ------
    ValueError
        If a number is not finite, or the quantiles are out of order.
    """
    if mean is None or q05 is None or q95 is None:
        middle, low, high = (format_number(v, exponent=0) for v in (mean, q05, q95))
        return middle, low, high
    for value in (mean, q05, q95):
        _check_finite(value)
    if q05 > q95:
        raise ValueError(f"expected q05 <= q95, got {q05!r} and {q95!r}")
    size = max(abs(mean), abs(q05), abs(q95))
    # Two digits of the width; four of the number where there is no width.
    place = _order(q95 - q05) - 1 if q95 > q05 else _order(size) - 3 if size else -1
    place = max(place, _order(size) + 1 - MOST_DIGITS) if size else place
    middle, low, high = (_fixed(v, exponent, exponent - place) for v in (mean, q05, q95))
    return middle, low, high


def error_cells(value: float | None, error: float | None) -> tuple[str, str]:
    """Write a value and its error as two cells, both to two significant digits of the error.

    Parameters
    ----------
    value, error : float or None
        The error is zero or above.

    Returns
    -------
    tuple of str
        With equal decimals; dashes for what is None.

    Raises
    ------
    ValueError
        If a number is not finite.
    """
    if value is None or error is None:
        return format_number(value, exponent=0), format_number(error, 2, exponent=0)
    _check_finite(error)
    # Round first: 0.0996 is 0.10 to two digits.
    error = float(f"{error:.1e}")
    place = _order(error) - 1 if error else _order(value) - 3
    place = max(place, _order(value) + 1 - MOST_DIGITS)
    least = 10.0**place
    error_cell = f"< {_fixed(least, 0, -place)}" if 0 < error < least else _fixed(error, 0, -place)
    return _fixed(value, 0, -place), error_cell


def factor_cells(log10: float | None, error: float | None) -> tuple[str, str]:
    """Write a log10 Bayes factor and its error as two cells; beyond 10⁶ to 1 it is told as that."""
    if log10 is None or abs(log10) <= CERTAIN:
        return error_cells(log10, error)
    return format_factor(log10), MISSING


def format_factor(log10: float | None) -> str:
    """Write a log10 Bayes factor to one decimal; beyond 10⁶ to 1 it is told as that."""
    if log10 is None or abs(log10) <= CERTAIN:
        return format_fixed(log10, 1)
    return f"> {CERTAIN:.0f}" if log10 > 0 else f"< −{CERTAIN:.0f}"


def format_shift(shift: float | None) -> str:
    """Write a shift in standard deviations to two decimals; beyond 10 it is told as that."""
    if shift is None or abs(shift) <= FAR_SHIFT:
        return format_fixed(shift, 2)
    return f"> {FAR_SHIFT:.0f}" if shift > 0 else f"< −{FAR_SHIFT:.0f}"


def format_count(count: int) -> str:
    """Write a whole number, from five digits on in groups of three: 12 000."""
    digits = f"{abs(count):,}".replace(",", THIN) if abs(count) >= 10_000 else str(abs(count))
    return ("−" if count < 0 else "") + digits


def format_fixed(value: float | None, decimals: int) -> str:
    """Write a number with so many decimals, a dash for None: −2.3, and no sign before a 0."""
    return MISSING if value is None else _fixed(value, 0, decimals)


def format_probability(p: float | None) -> str:
    """Write a probability as :func:`~bayesfric.probabilities.stated` does, a dash for None."""
    return MISSING if p is None else stated(p)


def format_share(share: float | None, digits: int = 2) -> str:
    """Write a share as a percentage of so many significant digits: 0.123 as 12 %."""
    if share is None:
        return MISSING
    _check_finite(share)
    return format_number(100 * share, digits=digits, exponent=0) + f"{THIN}%"


def three_digits(words: str) -> str:
    """Return words with three significant digits of each number that has a decimal point."""
    return _DECIMAL.sub(lambda match: f"{float(match[0]):.3g}", words)


def _check_finite(value: float) -> None:
    if not math.isfinite(value):
        raise ValueError(f"expected a finite number, got {value!r}")


def _order(value: float) -> int:
    """Power of ten of the first digit: 0 for 2.79, −2 for 0.0128."""
    return int(f"{abs(value):.15e}".split("e")[1])


def _power(size: float) -> int:
    return 0 if size == 0 or 1e-3 <= size < 1e6 else _order(size)


def _fixed(value: float, power: int, decimals: int) -> str:
    # In decimals, since 2.79e-5 / 1e-5 is not 2.79 in doubles.
    scaled = Decimal(repr(float(value))).scaleb(-power)
    if decimals < 0:
        scaled = scaled.quantize(Decimal(1).scaleb(-decimals))
    text = f"{scaled:.{max(decimals, 0)}f}"
    negative = text.startswith("-") and any(digit in text for digit in "123456789")
    return ("−" if negative else "") + text.lstrip("-")


def _times(power: int) -> str:
    return f" × 10{str(power).translate(RAISED)}" if power else ""


def _spaced(unit: str | None) -> str:
    printed = format_unit(unit)
    return printed if printed in ("", "°") else THIN + printed

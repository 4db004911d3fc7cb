"""Numbers with as many digits as their errors allow."""

import math

SURE = 6  # significant digits of a number with unknown error
LONGEST = 12  # most decimals that are written out; smaller numbers have a power of ten


def rounded(value: float, error: float | None) -> float:
    """Return a number rounded to the digits that its error allows.

    Parameters
    ----------
    value : float
        The number.
    error : float or None
        Its standard deviation, of which two digits count; None or 0 if unknown.
    """
    return float(f"{value:.{SURE}g}") if not error else round(value, _decimals(error))


def by_error(value: float, error: float | None) -> str:
    """Return a number, as text, with these digits; arguments as for :func:`rounded`."""
    if not error:
        return f"{value:.{SURE}g}"
    decimals = _decimals(error)
    near = round(value, decimals) + 0.0  # no minus before a zero
    if decimals <= LONGEST:
        return f"{near:.{max(decimals, 0)}f}"
    digits = 0 if near == 0 else max(decimals + math.floor(math.log10(abs(near))), 0)
    return f"{near:.{digits}e}"


def _decimals(error: float) -> int:
    return 1 - math.floor(math.log10(float(f"{error:.1e}")))

"""Numbers with as many digits as their errors leave of them."""

import math

SURE = 6  # significant digits of a number whose error nobody knows
LONGEST = 12  # decimals that are written out; smaller numbers have a power of ten


def rounded(value: float, error: float | None) -> float:
    """Return a number without the digits that its error makes meaningless.

    Parameters
    ----------
    value : float
        The number.
    error : float or None
        Its standard deviation, of which two digits count; None, or 0, where nobody knows it.
    """
    return float(f"{value:.{SURE}g}") if not error else round(value, _decimals(error))


def by_error(value: float, error: float | None) -> str:
    """Return a number as a text with these digits; arguments are those of :func:`rounded`."""
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

"""How a probability is written, in sentences and in tables alike."""

__all__ = ["bound_of", "stated", "stated_of_draws"]

LEAST = 0.001  # below it, and as close to 1, a probability is stated as a bound


def stated(p: float, least: float = LEAST) -> str:
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
    return stated(p, max(LEAST, bound_of(draws)) if p in (0, 1) else LEAST)


def bound_of(draws: float) -> float:
    """Return the probability below which, at 95 %, something is that none of the draws had."""
    return float(1 - 0.05 ** (1 / draws))

"""Odds and shares in the words of a claim's reason."""

LARGEST_LOG10 = 6.0  # log10, beyond which odds say more of the models than of the data
ROUND_FROM = 10.0  # odds, from which on two digits are a whole number


def odds(log10: float) -> str:
    """Return a Bayes factor in words, as in ``20 to 1``, up to a million to one."""
    size = abs(log10)
    if size > LARGEST_LOG10:
        return "more than 10⁶ to 1" if log10 > 0 else "less than 1 to 10⁶"
    number = f"{10**size:.2g}"
    if 10**size >= ROUND_FROM:
        number = f"{float(number):,.0f}".replace(",", "\u202f")
    return f"{number} to 1" if log10 >= 0 else f"1 to {number}"


def share(value: float) -> str:
    """Return a share as a percentage of two digits."""
    return f"{100 * value:.2g} %"

"""Odds and shares in the words of a claim's reason."""

SUPERSCRIPTS = "⁰¹²³⁴⁵⁶⁷⁸⁹"
POWER_OF_TEN_FROM = 2.0  # log10, from which on odds are a power of ten
LARGEST_LOG10 = 6.0  # log10, beyond which odds say more of the models than of the data


def odds(log10: float) -> str:
    """Return a Bayes factor in words, as in ``20 to 1``, up to a million to one."""
    size = abs(log10)
    if size > LARGEST_LOG10:
        return "more than 10⁶ to 1" if log10 > 0 else "less than 1 to 10⁶"
    digits = "".join(SUPERSCRIPTS[int(digit)] for digit in str(round(size)))
    number = f"{10**size:.2g}" if size < POWER_OF_TEN_FROM else f"10{digits}"
    return f"{number} to 1" if log10 >= 0 else f"1 to {number}"


def share(value: float) -> str:
    """Return a share as a percentage of two digits."""
    return f"{100 * value:.2g} %"

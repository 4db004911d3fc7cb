"""How figures write parameters and pulley sizes, and in which order sizes stand."""

import math
import re
from collections.abc import Iterable
from functools import cache

from matplotlib.font_manager import findfont, get_font
from matplotlib.ticker import FuncFormatter, ScalarFormatter

SYMBOLS = {
    "c1": "c_1",
    "c2": "c_2",
    "c3": "c_3",
    "tau": "τ",
    "omega": "ω",
    "omega_intercept": "ω_2",
    "wander": "ζ",
    "wander_length": "ℓ",
    "sigma_x": "σ_x",
    "sigma_t": "σ_t",
    "sigma_a": "σ_a",
    "torque_constant_factor": "κ",
    "sigma_current": "σ_I",
    "load_noise": "λ",
}
"""Parameter to formula, in the notation of TeX."""

AXES = {"n_pulleys": "number of pulleys", "trial_in_setup": "trial of its setup"}
RAISED = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
OF_A_SIZE = re.compile(r"c1\[(.+)\]")
FITTING = (5, 4, 6)  # panels beside each other, the most legible number first
LONGEST = 24  # characters of a name that a panel has room for


def sizes_of(law: Iterable[str]) -> tuple[str, ...]:
    """Return the pulley sizes that the coefficients of a law name, in its order.

    Parameters
    ----------
    law : iterable of str
        Names of coefficients, as ``c1[small]``.
    """
    return tuple(match[1] for name in law if (match := OF_A_SIZE.fullmatch(name)))


def parameter_label(name: str) -> str:
    """Write a parameter for a figure, ``c1[small]`` as $c_1$ small.

    Parameters
    ----------
    name : str
        As stored.

    Returns
    -------
    str
        A formula in matplotlib's notation, followed by whose it is if that is said.
    """
    stem, whose = parts(name)
    written = f"${SYMBOLS[stem]}$" if stem in SYMBOLS else plain(stem.replace("_", " "))
    return f"{written} {plain(whose)}" if whose else written


def parts(name: str) -> tuple[str, str]:
    """Part a parameter's name into what it is and whose.

    Parameters
    ----------
    name : str
        As stored.

    Returns
    -------
    tuple of str
        Of ``c1[small]``, ``c1`` and ``small``; of ``tau_rig``, where no parameter has that
        name of its own, ``tau`` and ``rig``; of others, the name and nothing.
    """
    stem, _, size = name.partition("[")
    whose = [size[:-1]] if size else []
    general, _, rig = stem.partition("_")
    if stem not in SYMBOLS and general in SYMBOLS and rig:
        stem, whose = general, [rig, *whose]
    return stem, " ".join(whose)


def axis_words(name: str) -> str:
    """Write the name of an axis: ``wrap_angle`` as wrap angle."""
    return AXES.get(name, name.replace("_", " "))


def rounded(middle: float, low: float, high: float) -> str:
    """Write the middle of an interval with the digits that its width allows, as tables do."""
    width = high - low
    return f"{middle:.{max(0, 1 - math.floor(math.log10(width)))}f}" if width > 0 else f"{middle:g}"


def columns_of(count: int) -> int:
    """Return how many panels stand beside each other, so that the last row is full if possible."""
    return min(count, min(FITTING, key=lambda columns: -(-count // columns) * columns))


def power_of_ten(exponent: int) -> str:
    """Write 10⁻³ in characters: a formula takes a hundred times as long to set."""
    return f"10{str(exponent).translate(RAISED)}"


def powers() -> FuncFormatter:
    """Return what writes the ticks of a logarithmic axis as powers of ten."""

    def written(value: float, _: int | None) -> str:
        if value == 0:
            return "0"
        sign = "−" if value < 0 else ""
        return sign + power_of_ten(round(math.log10(abs(value))))

    return FuncFormatter(written)


def numbers() -> FuncFormatter:
    """Return what writes the ticks of a logarithmic axis as numbers, 0.1 and 10."""
    return FuncFormatter(lambda value, _: f"{value:g}")


class CommonFactor(ScalarFormatter):  # type: ignore[misc, unused-ignore]
    """Ticks of an axis with one power of ten for all, in characters."""

    def get_offset(self) -> str:
        """Return the power of ten; nothing where it is 1."""
        said = str(super().get_offset()).replace("−", "-")  # as 1e-3
        exponent = said.partition("e")[2]
        return f"×{power_of_ten(int(exponent))}" if exponent else said


def ordered_sizes(names: Iterable[str]) -> list[str]:
    """Return each pulley size once: small, medium, large, then others as they come."""
    usual = ("small", "medium", "large")
    sizes = [str(name) for name in dict.fromkeys(names)]
    return [size for size in usual if size in sizes] + [s for s in sizes if s not in usual]


def plain(text: str) -> str:
    """Return a user's name with its markup characters escaped.

    Characters that the figures' font lacks are replaced by their code. A name that is longer than
    a panel is cut.
    """
    text = text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}…"
    shown = (c if ord(c) in _glyphs() and c.isprintable() else f"[U+{ord(c):04X}]" for c in text)
    return "".join(shown).replace("$", r"\$")


@cache
def _glyphs() -> frozenset[int]:
    return frozenset(get_font(findfont("DejaVu Sans")).get_charmap())

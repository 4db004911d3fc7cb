"""The statements and numbers of the paper, read from ``data/paper/paper.toml``.

Source: Miyasaka, Matheson, Lewis and Hannaford, IROS 2015 ("the paper"). This
module only reads; nothing here is used as a prior (see :mod:`bayesfric.inference.priors`).
"""

from dataclasses import dataclass
from functools import cache
from typing import Any

from bayesfric.files import read_toml
from bayesfric.resources import data_folder


@dataclass(frozen=True)
class PaperCoefficient:
    """A printed number with the rounding of its last digit.

    Parameters
    ----------
    value : float
        As printed.
    rounding : float
        Half a unit of the last printed digit.
    """

    value: float
    rounding: float


@dataclass(frozen=True)
class PaperPulley:
    """One row of Table I.

    Parameters
    ----------
    radius_m : float
        Pulley radius [m].
    c1 : PaperCoefficient
        Friction per tension and pulley [-].
    c2 : PaperCoefficient
        Constant friction a pulley [N].
    c3 : PaperCoefficient
        Change of c1 with the wrap angle [1/deg].
    """

    radius_m: float
    c1: PaperCoefficient
    c2: PaperCoefficient
    c3: PaperCoefficient


@cache
def paper() -> dict[str, Any]:
    """Return the whole of ``paper.toml`` (treat it as read-only)."""
    return read_toml(data_folder() / "paper" / "paper.toml")


@cache
def table1() -> dict[str, PaperPulley]:
    """Return Table I, pulley size to row, small to large."""
    return {
        size: PaperPulley(
            radius_m=row["radius_mm"] / 1000,
            c1=_printed(row["c1"]),
            c2=_printed(row["c2_n"]),
            c3=_printed(row["c3_per_deg"]),
        )
        for size, row in paper()["table1"].items()
        if isinstance(row, dict)
    }


def _printed(text: str) -> PaperCoefficient:
    mantissa, _, exponent = text.partition("e")
    decimals = len(mantissa.partition(".")[2])
    return PaperCoefficient(float(text), 0.5 * 10.0 ** (int(exponent or 0) - decimals))

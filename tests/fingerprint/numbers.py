"""A number of the fingerprint, how far it may be off, and whether it is."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

Bound = Literal["closed", "integrated", "draws"]
RELATIVE = {"closed": 1e-8, "integrated": 1e-5}
ERRORS = 4.0  # Monte Carlo standard errors
SMALLEST = 1e-2
"""Of the largest of a list of numbers: one that is smaller may be off by as much as one of this
size, since it is a difference of larger ones."""
DIGITS = 12  # that are kept


@dataclass(frozen=True)
class Number:
    """A number, a list of numbers of one kind, or a text.

    Parameters
    ----------
    value : float, tuple of float or str
        A text has to be the same.
    bound : {"closed", "integrated", "draws"}
        How far it may be off: 1e-8 of it, 1e-5 of it, or four of its errors.
    error : float or None
        Monte Carlo standard error; of draws alone.
    """

    value: float | tuple[float, ...] | str
    bound: Bound
    error: float | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.value, str) and not np.isfinite(self.value).all():
            raise ValueError(f"a number of the fingerprint is not finite: {self.value}")
        drawn = self.error is not None and math.isfinite(self.error) and self.error > 0
        if drawn != (self.bound == "draws"):
            raise ValueError(f"draws have an error above zero, and nothing else has: {self}")


def closed(value: Any) -> Number:
    """Return a number that a closed form gives, or several."""
    return Number(_plain(value), "closed")


def integrated(value: Any) -> Number:
    """Return a number that an optimiser or an integral gives, or several."""
    return Number(_plain(value), "integrated")


def drawn(value: float, error: float) -> Number:
    """Return a number that draws give, with its Monte Carlo standard error."""
    return Number(_plain(value), "draws", _rounded(float(error)))


def text(value: str) -> Number:
    """Return a text, as a verdict is."""
    return Number(value, "closed")


def farthest(kept: Number, new: Number) -> float:
    """Return how far a number has moved, in units of its bound; above 1 it has moved.

    An error that is twice or half of what it was counts as a move too.

    Parameters
    ----------
    kept : Number
        Of the file, whose bound and error count.
    new : Number
        As computed.
    """
    if isinstance(kept.value, str) or isinstance(new.value, str):
        return 0.0 if kept.value == new.value else math.inf
    before, after = np.atleast_1d(kept.value), np.atleast_1d(new.value)
    if before.shape != after.shape or kept.bound != new.bound:
        return math.inf
    if kept.error is not None and new.error is not None:
        if not 0.5 < new.error / kept.error < 2.0:
            return math.inf
        return float(np.abs(after - before).max() / (ERRORS * kept.error))
    size = np.maximum(np.abs(before), SMALLEST * np.abs(before).max(initial=0.0))
    off = np.abs(after - before)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        share = np.where(off > 0, off / (RELATIVE[kept.bound] * size), 0.0)
    return float(share.max(initial=0.0))


def moved(kept: Mapping[str, Number], new: Mapping[str, Number]) -> dict[str, float]:
    """Return names that came, went (both infinity) or moved, with how far in units of the bound."""
    shares = dict.fromkeys(sorted(set(kept) ^ set(new)), math.inf)
    for name in sorted(set(kept) & set(new)):
        share = farthest(kept[name], new[name])
        if share > 1:
            shares[name] = share
    return shares


def as_json(number: Number) -> dict[str, Any]:
    """Return a number as the file has it."""
    value = list(number.value) if isinstance(number.value, tuple) else number.value
    return {"value": value, "bound": number.bound, "error": number.error}


def from_json(row: Mapping[str, Any]) -> Number:
    """Return a number from what the file has."""
    value = row["value"]
    return Number(tuple(value) if isinstance(value, list) else value, row["bound"], row["error"])


def _plain(value: Any) -> float | tuple[float, ...]:
    if isinstance(value, Sequence | np.ndarray) and np.ndim(value):
        return tuple(_rounded(float(item)) for item in np.asarray(value).ravel())
    return _rounded(float(value))


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")

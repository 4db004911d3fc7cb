"""Arrays of NumPy as signatures call them; their shapes are told in words."""

from dataclasses import fields, is_dataclass, replace
from typing import Any, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
Complex: TypeAlias = NDArray[np.complex128]
Flags: TypeAlias = NDArray[np.bool_]
Whole: TypeAlias = NDArray[np.intp]
Record = TypeVar("Record")


def taken(record: Record, rows: Whole) -> Record:
    """Return some of the draws: the last axis of each array of a record and of those in it."""

    def some(value: Any) -> Any:
        if isinstance(value, np.ndarray):
            return value[..., rows]
        if is_dataclass(value) and not isinstance(value, type):
            return replace(value, **{f.name: some(getattr(value, f.name)) for f in fields(value)})
        if isinstance(value, tuple):
            parts = map(some, value)
            return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)
        return value

    of_record: Record = some(record)
    return of_record


class PerDraw:
    """A state that changes, whose arrays have the draws in their last axis."""

    def keep(self, rows: Whole) -> None:
        """Keep some of the draws and drop the others."""
        for name, value in vars(self).items():
            setattr(self, name, taken(value, rows))


def evenly(count: int, most: int) -> Whole:
    """Return at most `most` of `count` places, evenly, the ends among them."""
    return np.unique(np.linspace(0, count - 1, most).astype(np.intp))

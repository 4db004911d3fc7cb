"""A deviation that rows of a group share, integrated out in closed form."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["SharedDeviation", "second_moments"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SharedDeviation:
    """A deviation that rows of a group share, integrated out.

    Parameters
    ----------
    columns, response, stiffness : ndarray, shape (G, k), (G,) and (G,)
        Sums over each group.
    taken : ndarray, shape (G,)
        So that the group's precision is less by it times the square of a sum.
    constant : float
        What the log density is more.
    """

    columns: Array
    response: Array
    stiffness: Array
    taken: Array
    constant: float

    @classmethod
    def of(cls, columns: Array, response: Array, stiffness: Array, sd: float) -> "SharedDeviation":
        """Integrate deviations of a standard deviation out."""
        taken = sd**2 / (1 + sd**2 * stiffness)
        constant = 0.5 * float((taken * response**2 - np.log1p(sd**2 * stiffness)).sum())
        return cls(columns, response, stiffness, taken, constant)

    def left(self, sums: Array) -> Array:
        """Return sums of groups without what their deviation takes up."""
        share = 1 - self.taken * self.stiffness
        return np.asarray(sums * (share[:, None] if sums.ndim > 1 else share))


def second_moments(
    columns: Array,
    response: Array,
    own: Array,
    size: NDArray[np.intp],
    mean: Sequence[Array],
    covariance: Sequence[Array],
) -> Array:
    """Return what a variance more along each row or group adds to the log evidence, doubled."""
    found = np.empty(own.size)
    for which, (m, v) in enumerate(zip(mean, covariance, strict=True)):
        mine = size == which
        left = columns[mine]
        found[mine] = (response[mine] - left @ m) ** 2 + ((left @ v) * left).sum(axis=1)
    return found - own

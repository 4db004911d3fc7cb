"""Where each number of the linear model stands.

The numbers are, for each pulley size, the three coefficients of the law and the smooth
forces of the discrepancy; then, shared by all sizes, an amplitude for each candidate,
small amounts of every effect (the rest of the discrepancy), what laws may be wrong by, and
the idle curve of the motor. A trial or run meets those of its own size only: its
columns are the *local* ones. All are in units of their prior's standard deviation.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["COEFFICIENTS", "Layout"]

COEFFICIENTS = 3  # c1, c2, c3


@dataclass(frozen=True)
class Layout:
    """Numbers of columns.

    Parameters
    ----------
    sizes : tuple of str
        Pulley sizes.
    smooths : int
        Smooth forces of each size, K.
    candidates : int
        Candidate effects, E.
    idle : int
        Columns of the idle curve, 0 without a motor board.
    small : int
        Small amounts of effects, and after them the other forms of those that act.
    """

    sizes: tuple[str, ...]
    smooths: int
    candidates: int
    idle: int
    small: int = 0

    @property
    def own(self) -> int:
        """Columns that a size has to itself."""
        return COEFFICIENTS + self.smooths

    @property
    def local(self) -> int:
        """Columns of a trial or run."""
        return self.own + self.candidates + self.small + self.idle

    def base(self) -> NDArray[np.intp]:
        """Local columns of every hypothesis: all but the candidates."""
        return np.concatenate([np.arange(self.own), self.always()])

    def always(self) -> NDArray[np.intp]:
        """Local columns, shared by all sizes, that every hypothesis has."""
        return np.arange(self.own + self.candidates, self.local)

    def candidate(self, place: int) -> int:
        """Local column of a candidate."""
        return self.own + place

    def small_amount(self, place: int) -> int:
        """Local column of a small amount of an effect."""
        return self.own + self.candidates + place

    def spread(self, kept: NDArray[np.intp], size: int) -> NDArray[np.intp]:
        """Return where the kept local columns of a size stand among all sizes' kept ones.

        Those of the first size come first, then the next; what is shared comes last.
        """
        mine = np.count_nonzero(kept < self.own)
        shared = np.arange(kept.size - mine) + mine * len(self.sizes)
        return np.concatenate([np.arange(mine) + mine * size, shared])

    def total(self, kept: NDArray[np.intp]) -> int:
        """Numbers in all, of the kept local columns."""
        mine = int(np.count_nonzero(kept < self.own))
        return mine * len(self.sizes) + kept.size - mine

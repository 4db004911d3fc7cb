"""What the data say of candidates at a noise, kept where many hypotheses start from it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from bayesfric.arrays import Array
from bayesfric.inference.information import Information

KEPT = 4  # noises


@dataclass
class Said:
    """Information on numbers, all candidates among them, at the last few noises."""

    _kept: dict[bytes, Information] = field(default_factory=dict)

    def of(
        self,
        psi: Array,
        places: Sequence[int],
        count: int,
        first: int,
        computed: Callable[[Sequence[int]], Information],
    ) -> Information:
        """Return the information with some candidates, in their order.

        Whatever is asked for, all candidates are computed: with fewer, sums would be rounded
        another way, and an answer would hang on what was asked before it.

        Parameters
        ----------
        psi : ndarray
            Logarithms of the noise.
        places : sequence of int
            The candidates.
        count : int
            How many candidates there are.
        first : int
            Number at which the candidates begin.
        computed : callable
            Of candidates, to the information there.
        """
        key = psi.tobytes()
        if key not in self._kept:
            while len(self._kept) >= KEPT:
                del self._kept[next(iter(self._kept))]
            self._kept[key] = computed(range(count))
        whole = self._kept[key]
        rest = np.arange(first + count, whole.slope.size)
        chosen = first + np.asarray(places, dtype=np.intp)
        return whole.at(np.concatenate([np.arange(first), chosen, rest]))

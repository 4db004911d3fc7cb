"""Caches the data's information on all candidates at recent noise parameters."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from bayesfric.arrays import Array
from bayesfric.inference.information import Information

KEPT = 4  # sets of noise parameters in the cache


@dataclass
class InformationCache:
    """Cache of the information on all numbers and candidates, by noise parameters."""

    _kept: dict[bytes, Information] = field(default_factory=dict)

    def of(
        self,
        psi: Array,
        places: Sequence[int],
        count: int,
        first: int,
        computed: Callable[[Sequence[int]], Information],
    ) -> Information:
        """Return the information on the numbers with some of the candidates, in their order.

        All candidates are always computed. With fewer, sums would be rounded differently, and a
        result would depend on earlier calls.

        Parameters
        ----------
        psi : ndarray
            Logarithms of the noise parameters.
        places : sequence of int
            The candidates.
        count : int
            How many candidates there are.
        first : int
            Position of the first candidate among the numbers.
        computed : callable
            Function of candidates that computes the information with them.
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
